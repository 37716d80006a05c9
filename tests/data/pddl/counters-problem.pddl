;; From 3 2 1 to a <= b - 1 <= c - 2: 1 2 3 is nearest, four steps away.
(define (problem three-counters)
  (:domain counters)
  (:objects a b c - counter)
  (:init (= (value a) 3) (= (value b) 2) (= (value c) 1) (= (most) 5))
  (:goal (and (<= (+ (value a) 1) (value b)) (<= (+ (value b) 1) (value c)))))
