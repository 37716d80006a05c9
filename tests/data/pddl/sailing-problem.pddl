;; x + y and y - x must both reach 4: only the two northern actions help, by 3 one of them each. Two each way and the
;; rescue are five actions.
(define (problem one-person)
  (:domain sailing)
  (:objects b - boat p - person)
  (:init (= (x b) 0) (= (y b) 0) (= (d p) 4))
  (:goal (saved p)))
