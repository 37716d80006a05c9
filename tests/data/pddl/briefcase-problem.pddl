;; Two things to the office, one of them fetched on the way: put in, move, put in, move. What is inside counts as there.
(define (problem to-the-office)
  (:domain briefcase)
  (:objects pen book - portable home shop office - location)
  (:init (is-at home) (at pen home) (at book shop))
  (:goal (and (at pen office) (at book office))))
