;; Moving costs 3 and what is carried. Three items of 1, 2 and 4 with a limit of 5 need two trips: whatever the split,
;; the items cost 7 to move and 12 to handle, and the three moves 9. 28 in all, although the cost of a move varies.
(define (problem three-items)
  (:domain delivery)
  (:objects store ward - room small middle large - item b - bot)
  (:init (in b store) (in small store) (in middle store) (in large store) (door store ward) (door ward store)
    (= (load b) 0) (= (limit b) 5) (= (weight small) 1) (= (weight middle) 2) (= (weight large) 4) (= (cost) 0))
  (:goal (and (in small ward) (in middle ward) (in large ward)))
  (:metric minimize (cost)))
