;; Two parcels from the office of one city to the other's: the truck fetches them to the airport (drive, 2 loads, drive,
;; 2 unloads), they fly (2 loads, fly, 2 unloads), the other truck comes for them and delivers. The second truck starts
;; at its airport: 6 + 5 + 2 + 1 + 2 = 16, and the plane starts away: one more flight.
(define (problem two-cities)
  (:domain logistics)
  (:objects paris rome - city p-office r-office - place p-airport r-airport - airport
    p-truck r-truck - truck jet - plane p1 p2 - parcel)
  (:init (in-city p-office paris) (in-city p-airport paris) (in-city r-office rome) (in-city r-airport rome)
    (at p-truck p-airport) (at r-truck r-airport) (at jet r-airport) (at p1 p-office) (at p2 p-office))
  (:goal (and (at p1 r-office) (at p2 r-office))))
