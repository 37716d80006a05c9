;; Four balls: two trips with two balls each, 3 moves + 4 picks + 4 drops = 11.
(define (problem four-balls)
  (:domain gripper)
  (:objects here there - room b1 b2 b3 b4 - ball left right - hand)
  (:init (robot-in here) (in b1 here) (in b2 here) (in b3 here) (in b4 here) (free left) (free right))
  (:goal (forall (?b - ball) (in ?b there))))
