;; A tower of six turned upside down: every block is lifted and put down once, 2 * 6 actions.
(define (problem reverse-six)
  (:domain blocks)
  (:objects a b c d e f - block)
  (:init (on a b) (on b c) (on c d) (on d e) (on e f) (on-table f) (clear a) (arm-empty))
  (:goal (and (on f e) (on e d) (on d c) (on c b) (on b a))))
