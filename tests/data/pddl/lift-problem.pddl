;; Two passengers, four floors; the first may not see the second's origin, so she is served before it is visited.
(define (problem two-passengers)
  (:domain lift)
  (:objects f0 f1 f2 f3 - floor ann bob - passenger)
  (:init (lift-at f0) (above f0 f1) (above f0 f2) (above f0 f3) (above f1 f2) (above f1 f3) (above f2 f3)
    (origin ann f1) (destination ann f3) (origin bob f2) (destination bob f0) (no-access ann f2) (= (total-cost) 0))
  (:goal (forall (?p - passenger) (served ?p)))
  (:metric minimize (total-cost)))
