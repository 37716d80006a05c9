;; One passenger from a to b, 10 away, with 30 left in a tank of 60. Slow costs 2 a unit and fast 5, so flying slowly
;; uses 20; with board and debark that is 4 * 3 + 5 * 20 = 112 by this metric.
(define (problem one-passenger)
  (:domain zenotravel)
  (:objects jet - plane p - person a b - city)
  (:init (at jet a) (at p a) (= (fuel jet) 30) (= (capacity jet) 60) (= (slow-burn jet) 2) (= (fast-burn jet) 5)
    (= (onboard jet) 0) (= (zoom-limit jet) 3) (= (total-fuel-used) 0)
    (= (distance a b) 10) (= (distance b a) 10) (= (distance a a) 0) (= (distance b b) 0))
  (:goal (at p b))
  (:metric minimize (+ (* 4 (total-time)) (* 5 (total-fuel-used)))))
