;; Medication delivery: a care robot fetches the requested medicine from a pharmacy and the requested supplement from a
;; supply room, checks both, and delivers them on a bedside table.
;;
;; Units: seconds, metres, radians; charge is the state of charge in [0, 1]. Every number that depends on the ward is a
;; fluent of the problem. Stage cost of an action: w' f, where the weights w0 ... w4 say what matters to the patient and
;; f = (time, safety, battery, proximity, approach) is scaled, so that whole rounds have features between 0 and 1.
;;
;; What a robot carries has a label. Collecting an item gives it the label that was asked for; a check reads the true
;; one. `check_..._correct` confirms a requested label. A wrong one (found by a check, or observed in any other way) is
;; confirmed by `check_..._wrong` and put back, and the item is collected again.

(define (domain medication)
  (:requirements :strips :typing :negative-preconditions :numeric-fluents :conditional-effects :universal-preconditions)

  (:types
    robot location item - object
    pharmacy supply charger bedside - location
    medicine supplement - item)

  (:constants
    pharmacy_north pharmacy_south - pharmacy
    supply_a supply_b - supply
    charge_main charge_backup - charger
    patient_bed_left patient_bed_right - bedside
    med_antibiotic med_analgesic med_insulin - medicine
    supp_vitamin_d supp_electrolyte supp_omega3 - supplement)

  (:predicates
    (at ?r - robot ?l - location)
    (open-way ?from ?to - location)                ; the leg has not been found blocked
    (available ?i - item ?l - location)            ; in stock, as observed: plans do not count what they take
    (requested-medicine ?m - medicine)
    (requested-supplement ?s - supplement)
    (has-medication ?r - robot)
    (medication-is ?r - robot ?m - medicine)       ; its label, as far as known
    (correct-medication ?r - robot)
    (wrong-medication ?r - robot)
    (has-supplement ?r - robot)
    (supplement-is ?r - robot ?s - supplement)
    (correct-supplement ?r - robot)
    (wrong-supplement ?r - robot)
    (delivered ?r - robot))

  (:functions
    (battery-soc ?r - robot)
    ;; Legs.
    (nav-time ?from ?to - location)                ; seconds
    (location-safety ?from ?to - location)         ; congestion risk rho collected on the way
    (nav-charge ?from ?to - location)              ; charge used
    (nav-battery ?from ?to - location)             ; charge to count on: at least what has been seen to be used
    (proximity-feature ?from ?to - location)       ; discomfort of the patient
    (nearest-charger-battery ?l - location)        ; charge needed from there to the nearest charger
    (approach-feature ?b - bedside)                ; how far from the ideal hand-over pose
    (standing-proximity ?b - bedside)              ; discomfort per second of standing there
    ;; Actions at a place: seconds, and charge used.
    (collect-time) (check-time) (put-down-time) (deliver-time) (recharge-time)
    (collect-battery) (check-battery) (put-down-battery) (deliver-battery)
    ;; How much of a scaled feature one unit is.
    (feature-per-second) (feature-per-risk) (feature-per-charge) (feature-per-discomfort) (feature-per-error)
    ;; Preference weights.
    (w0) (w1) (w2) (w3) (w4)
    (terminal-weight)
    ;; Accumulated by the actions.
    (stage_cost)
    (total_time)                                   ; seconds
    (discrete_steps))

  ;; Movements. The charge after a move must suffice to reach the nearest charger from there; arriving low costs extra.

  (:action go_to_pharmacy_north
    :parameters (?r - robot ?from - location)
    :precondition (and
      (at ?r ?from)
      (open-way ?from pharmacy_north)
      (>= (- (battery-soc ?r) (nav-battery ?from pharmacy_north)) (nearest-charger-battery pharmacy_north)))
    :effect (and
      (not (at ?r ?from))
      (at ?r pharmacy_north)
      (decrease (battery-soc ?r) (nav-battery ?from pharmacy_north))
      (increase (stage_cost) (+
        (* (w0) (nav-time ?from pharmacy_north) (feature-per-second))
        (* (w1) (location-safety ?from pharmacy_north) (feature-per-risk))
        (* (w2) (nav-charge ?from pharmacy_north) (feature-per-charge))
        (* (w3) (proximity-feature ?from pharmacy_north) (feature-per-discomfort))))
      (when (< (- (battery-soc ?r) (nav-battery ?from pharmacy_north)) 0.15) (increase (stage_cost) (* (w2) 0.5)))
      (when (< (- (battery-soc ?r) (nav-battery ?from pharmacy_north)) 0.25) (increase (stage_cost) (* (w2) 0.2)))
      (increase (total_time) (nav-time ?from pharmacy_north))
      (increase (discrete_steps) 1)))

  (:action go_to_pharmacy_south
    :parameters (?r - robot ?from - location)
    :precondition (and
      (at ?r ?from)
      (open-way ?from pharmacy_south)
      (>= (- (battery-soc ?r) (nav-battery ?from pharmacy_south)) (nearest-charger-battery pharmacy_south)))
    :effect (and
      (not (at ?r ?from))
      (at ?r pharmacy_south)
      (decrease (battery-soc ?r) (nav-battery ?from pharmacy_south))
      (increase (stage_cost) (+
        (* (w0) (nav-time ?from pharmacy_south) (feature-per-second))
        (* (w1) (location-safety ?from pharmacy_south) (feature-per-risk))
        (* (w2) (nav-charge ?from pharmacy_south) (feature-per-charge))
        (* (w3) (proximity-feature ?from pharmacy_south) (feature-per-discomfort))))
      (when (< (- (battery-soc ?r) (nav-battery ?from pharmacy_south)) 0.15) (increase (stage_cost) (* (w2) 0.5)))
      (when (< (- (battery-soc ?r) (nav-battery ?from pharmacy_south)) 0.25) (increase (stage_cost) (* (w2) 0.2)))
      (increase (total_time) (nav-time ?from pharmacy_south))
      (increase (discrete_steps) 1)))

  (:action go_to_supply_a
    :parameters (?r - robot ?from - location)
    :precondition (and
      (at ?r ?from)
      (open-way ?from supply_a)
      (>= (- (battery-soc ?r) (nav-battery ?from supply_a)) (nearest-charger-battery supply_a)))
    :effect (and
      (not (at ?r ?from))
      (at ?r supply_a)
      (decrease (battery-soc ?r) (nav-battery ?from supply_a))
      (increase (stage_cost) (+
        (* (w0) (nav-time ?from supply_a) (feature-per-second))
        (* (w1) (location-safety ?from supply_a) (feature-per-risk))
        (* (w2) (nav-charge ?from supply_a) (feature-per-charge))
        (* (w3) (proximity-feature ?from supply_a) (feature-per-discomfort))))
      (when (< (- (battery-soc ?r) (nav-battery ?from supply_a)) 0.15) (increase (stage_cost) (* (w2) 0.5)))
      (when (< (- (battery-soc ?r) (nav-battery ?from supply_a)) 0.25) (increase (stage_cost) (* (w2) 0.2)))
      (increase (total_time) (nav-time ?from supply_a))
      (increase (discrete_steps) 1)))

  (:action go_to_supply_b
    :parameters (?r - robot ?from - location)
    :precondition (and
      (at ?r ?from)
      (open-way ?from supply_b)
      (>= (- (battery-soc ?r) (nav-battery ?from supply_b)) (nearest-charger-battery supply_b)))
    :effect (and
      (not (at ?r ?from))
      (at ?r supply_b)
      (decrease (battery-soc ?r) (nav-battery ?from supply_b))
      (increase (stage_cost) (+
        (* (w0) (nav-time ?from supply_b) (feature-per-second))
        (* (w1) (location-safety ?from supply_b) (feature-per-risk))
        (* (w2) (nav-charge ?from supply_b) (feature-per-charge))
        (* (w3) (proximity-feature ?from supply_b) (feature-per-discomfort))))
      (when (< (- (battery-soc ?r) (nav-battery ?from supply_b)) 0.15) (increase (stage_cost) (* (w2) 0.5)))
      (when (< (- (battery-soc ?r) (nav-battery ?from supply_b)) 0.25) (increase (stage_cost) (* (w2) 0.2)))
      (increase (total_time) (nav-time ?from supply_b))
      (increase (discrete_steps) 1)))

  (:action go_to_charge_main
    :parameters (?r - robot ?from - location)
    :precondition (and
      (at ?r ?from)
      (open-way ?from charge_main)
      (>= (- (battery-soc ?r) (nav-battery ?from charge_main)) (nearest-charger-battery charge_main)))
    :effect (and
      (not (at ?r ?from))
      (at ?r charge_main)
      (decrease (battery-soc ?r) (nav-battery ?from charge_main))
      (increase (stage_cost) (+
        (* (w0) (nav-time ?from charge_main) (feature-per-second))
        (* (w1) (location-safety ?from charge_main) (feature-per-risk))
        (* (w2) (nav-charge ?from charge_main) (feature-per-charge))
        (* (w3) (proximity-feature ?from charge_main) (feature-per-discomfort))))
      (when (< (- (battery-soc ?r) (nav-battery ?from charge_main)) 0.15) (increase (stage_cost) (* (w2) 0.5)))
      (when (< (- (battery-soc ?r) (nav-battery ?from charge_main)) 0.25) (increase (stage_cost) (* (w2) 0.2)))
      (increase (total_time) (nav-time ?from charge_main))
      (increase (discrete_steps) 1)))

  (:action go_to_charge_backup
    :parameters (?r - robot ?from - location)
    :precondition (and
      (at ?r ?from)
      (open-way ?from charge_backup)
      (>= (- (battery-soc ?r) (nav-battery ?from charge_backup)) (nearest-charger-battery charge_backup)))
    :effect (and
      (not (at ?r ?from))
      (at ?r charge_backup)
      (decrease (battery-soc ?r) (nav-battery ?from charge_backup))
      (increase (stage_cost) (+
        (* (w0) (nav-time ?from charge_backup) (feature-per-second))
        (* (w1) (location-safety ?from charge_backup) (feature-per-risk))
        (* (w2) (nav-charge ?from charge_backup) (feature-per-charge))
        (* (w3) (proximity-feature ?from charge_backup) (feature-per-discomfort))))
      (when (< (- (battery-soc ?r) (nav-battery ?from charge_backup)) 0.15) (increase (stage_cost) (* (w2) 0.5)))
      (when (< (- (battery-soc ?r) (nav-battery ?from charge_backup)) 0.25) (increase (stage_cost) (* (w2) 0.2)))
      (increase (total_time) (nav-time ?from charge_backup))
      (increase (discrete_steps) 1)))

  ;; The charge left at the bedside must suffice for the delivery, too.

  (:action approach_left_to_bed
    :parameters (?r - robot ?from - location)
    :precondition (and
      (at ?r ?from)
      (open-way ?from patient_bed_left)
      (>= (- (battery-soc ?r) (nav-battery ?from patient_bed_left))
        (+ (nearest-charger-battery patient_bed_left) (deliver-battery))))
    :effect (and
      (not (at ?r ?from))
      (at ?r patient_bed_left)
      (decrease (battery-soc ?r) (nav-battery ?from patient_bed_left))
      (increase (stage_cost) (+
        (* (w0) (nav-time ?from patient_bed_left) (feature-per-second))
        (* (w1) (location-safety ?from patient_bed_left) (feature-per-risk))
        (* (w2) (nav-charge ?from patient_bed_left) (feature-per-charge))
        (* (w3) (proximity-feature ?from patient_bed_left) (feature-per-discomfort))
        (* (w4) (approach-feature patient_bed_left) (feature-per-error))))
      (when (< (- (battery-soc ?r) (nav-battery ?from patient_bed_left)) 0.15) (increase (stage_cost) (* (w2) 0.5)))
      (when (< (- (battery-soc ?r) (nav-battery ?from patient_bed_left)) 0.25) (increase (stage_cost) (* (w2) 0.2)))
      (increase (total_time) (nav-time ?from patient_bed_left))
      (increase (discrete_steps) 1)))

  (:action approach_right_to_bed
    :parameters (?r - robot ?from - location)
    :precondition (and
      (at ?r ?from)
      (open-way ?from patient_bed_right)
      (>= (- (battery-soc ?r) (nav-battery ?from patient_bed_right))
        (+ (nearest-charger-battery patient_bed_right) (deliver-battery))))
    :effect (and
      (not (at ?r ?from))
      (at ?r patient_bed_right)
      (decrease (battery-soc ?r) (nav-battery ?from patient_bed_right))
      (increase (stage_cost) (+
        (* (w0) (nav-time ?from patient_bed_right) (feature-per-second))
        (* (w1) (location-safety ?from patient_bed_right) (feature-per-risk))
        (* (w2) (nav-charge ?from patient_bed_right) (feature-per-charge))
        (* (w3) (proximity-feature ?from patient_bed_right) (feature-per-discomfort))
        (* (w4) (approach-feature patient_bed_right) (feature-per-error))))
      (when (< (- (battery-soc ?r) (nav-battery ?from patient_bed_right)) 0.15) (increase (stage_cost) (* (w2) 0.5)))
      (when (< (- (battery-soc ?r) (nav-battery ?from patient_bed_right)) 0.25) (increase (stage_cost) (* (w2) 0.2)))
      (increase (total_time) (nav-time ?from patient_bed_right))
      (increase (discrete_steps) 1)))

  ;; Collecting, checking and putting down: what is wrong can go back only where it came from.

  (:action collect_med_antibiotic
    :parameters (?r - robot ?l - pharmacy)
    :precondition (and
      (at ?r ?l)
      (available med_antibiotic ?l)
      (not (has-medication ?r))
      (>= (- (battery-soc ?r) (collect-battery)) (nearest-charger-battery ?l)))
    :effect (and
      (has-medication ?r)
      (forall (?other - medicine) (not (medication-is ?r ?other)))
      (medication-is ?r med_antibiotic)
      (decrease (battery-soc ?r) (collect-battery))
      (increase (stage_cost) (+
        (* (w0) (collect-time) (feature-per-second))
        (* (w2) (collect-battery) (feature-per-charge))))
      (increase (total_time) (collect-time))
      (increase (discrete_steps) 1)))

  (:action collect_med_analgesic
    :parameters (?r - robot ?l - pharmacy)
    :precondition (and
      (at ?r ?l)
      (available med_analgesic ?l)
      (not (has-medication ?r))
      (>= (- (battery-soc ?r) (collect-battery)) (nearest-charger-battery ?l)))
    :effect (and
      (has-medication ?r)
      (forall (?other - medicine) (not (medication-is ?r ?other)))
      (medication-is ?r med_analgesic)
      (decrease (battery-soc ?r) (collect-battery))
      (increase (stage_cost) (+
        (* (w0) (collect-time) (feature-per-second))
        (* (w2) (collect-battery) (feature-per-charge))))
      (increase (total_time) (collect-time))
      (increase (discrete_steps) 1)))

  (:action collect_med_insulin
    :parameters (?r - robot ?l - pharmacy)
    :precondition (and
      (at ?r ?l)
      (available med_insulin ?l)
      (not (has-medication ?r))
      (>= (- (battery-soc ?r) (collect-battery)) (nearest-charger-battery ?l)))
    :effect (and
      (has-medication ?r)
      (forall (?other - medicine) (not (medication-is ?r ?other)))
      (medication-is ?r med_insulin)
      (decrease (battery-soc ?r) (collect-battery))
      (increase (stage_cost) (+
        (* (w0) (collect-time) (feature-per-second))
        (* (w2) (collect-battery) (feature-per-charge))))
      (increase (total_time) (collect-time))
      (increase (discrete_steps) 1)))

  (:action check_medication_correct
    :parameters (?r - robot ?l - pharmacy ?m - medicine)
    :precondition (and
      (at ?r ?l)
      (has-medication ?r)
      (medication-is ?r ?m)
      (requested-medicine ?m)
      (not (correct-medication ?r))
      (>= (- (battery-soc ?r) (check-battery)) (nearest-charger-battery ?l)))
    :effect (and
      (correct-medication ?r)
      (decrease (battery-soc ?r) (check-battery))
      (increase (stage_cost) (+
        (* (w0) (check-time) (feature-per-second))
        (* (w2) (check-battery) (feature-per-charge))))
      (increase (total_time) (check-time))
      (increase (discrete_steps) 1)))

  (:action check_medication_wrong
    :parameters (?r - robot ?l - pharmacy ?m - medicine)
    :precondition (and
      (at ?r ?l)
      (has-medication ?r)
      (medication-is ?r ?m)
      (not (requested-medicine ?m))
      (not (wrong-medication ?r))
      (>= (- (battery-soc ?r) (check-battery)) (nearest-charger-battery ?l)))
    :effect (and
      (wrong-medication ?r)
      (decrease (battery-soc ?r) (check-battery))
      (increase (stage_cost) (+
        (* (w0) (check-time) (feature-per-second))
        (* (w2) (check-battery) (feature-per-charge))))
      (increase (total_time) (check-time))
      (increase (discrete_steps) 1)))

  (:action put_down_medicine
    :parameters (?r - robot ?l - pharmacy ?m - medicine)
    :precondition (and
      (at ?r ?l)
      (has-medication ?r)
      (medication-is ?r ?m)
      (wrong-medication ?r)
      (>= (- (battery-soc ?r) (put-down-battery)) (nearest-charger-battery ?l)))
    :effect (and
      (not (has-medication ?r))
      (not (correct-medication ?r))
      (not (wrong-medication ?r))
      (not (medication-is ?r ?m))
      (available ?m ?l)
      (decrease (battery-soc ?r) (put-down-battery))
      (increase (stage_cost) (+
        (* (w0) (put-down-time) (feature-per-second))
        (* (w2) (put-down-battery) (feature-per-charge))))
      (increase (total_time) (put-down-time))
      (increase (discrete_steps) 1)))

  (:action collect_supp_vitamin_d
    :parameters (?r - robot ?l - supply)
    :precondition (and
      (at ?r ?l)
      (available supp_vitamin_d ?l)
      (not (has-supplement ?r))
      (>= (- (battery-soc ?r) (collect-battery)) (nearest-charger-battery ?l)))
    :effect (and
      (has-supplement ?r)
      (forall (?other - supplement) (not (supplement-is ?r ?other)))
      (supplement-is ?r supp_vitamin_d)
      (decrease (battery-soc ?r) (collect-battery))
      (increase (stage_cost) (+
        (* (w0) (collect-time) (feature-per-second))
        (* (w2) (collect-battery) (feature-per-charge))))
      (increase (total_time) (collect-time))
      (increase (discrete_steps) 1)))

  (:action collect_supp_electrolyte
    :parameters (?r - robot ?l - supply)
    :precondition (and
      (at ?r ?l)
      (available supp_electrolyte ?l)
      (not (has-supplement ?r))
      (>= (- (battery-soc ?r) (collect-battery)) (nearest-charger-battery ?l)))
    :effect (and
      (has-supplement ?r)
      (forall (?other - supplement) (not (supplement-is ?r ?other)))
      (supplement-is ?r supp_electrolyte)
      (decrease (battery-soc ?r) (collect-battery))
      (increase (stage_cost) (+
        (* (w0) (collect-time) (feature-per-second))
        (* (w2) (collect-battery) (feature-per-charge))))
      (increase (total_time) (collect-time))
      (increase (discrete_steps) 1)))

  (:action collect_supp_omega3
    :parameters (?r - robot ?l - supply)
    :precondition (and
      (at ?r ?l)
      (available supp_omega3 ?l)
      (not (has-supplement ?r))
      (>= (- (battery-soc ?r) (collect-battery)) (nearest-charger-battery ?l)))
    :effect (and
      (has-supplement ?r)
      (forall (?other - supplement) (not (supplement-is ?r ?other)))
      (supplement-is ?r supp_omega3)
      (decrease (battery-soc ?r) (collect-battery))
      (increase (stage_cost) (+
        (* (w0) (collect-time) (feature-per-second))
        (* (w2) (collect-battery) (feature-per-charge))))
      (increase (total_time) (collect-time))
      (increase (discrete_steps) 1)))

  (:action check_supplement_correct
    :parameters (?r - robot ?l - supply ?s - supplement)
    :precondition (and
      (at ?r ?l)
      (has-supplement ?r)
      (supplement-is ?r ?s)
      (requested-supplement ?s)
      (not (correct-supplement ?r))
      (>= (- (battery-soc ?r) (check-battery)) (nearest-charger-battery ?l)))
    :effect (and
      (correct-supplement ?r)
      (decrease (battery-soc ?r) (check-battery))
      (increase (stage_cost) (+
        (* (w0) (check-time) (feature-per-second))
        (* (w2) (check-battery) (feature-per-charge))))
      (increase (total_time) (check-time))
      (increase (discrete_steps) 1)))

  (:action check_supplement_wrong
    :parameters (?r - robot ?l - supply ?s - supplement)
    :precondition (and
      (at ?r ?l)
      (has-supplement ?r)
      (supplement-is ?r ?s)
      (not (requested-supplement ?s))
      (not (wrong-supplement ?r))
      (>= (- (battery-soc ?r) (check-battery)) (nearest-charger-battery ?l)))
    :effect (and
      (wrong-supplement ?r)
      (decrease (battery-soc ?r) (check-battery))
      (increase (stage_cost) (+
        (* (w0) (check-time) (feature-per-second))
        (* (w2) (check-battery) (feature-per-charge))))
      (increase (total_time) (check-time))
      (increase (discrete_steps) 1)))

  (:action put_down_supplement
    :parameters (?r - robot ?l - supply ?s - supplement)
    :precondition (and
      (at ?r ?l)
      (has-supplement ?r)
      (supplement-is ?r ?s)
      (wrong-supplement ?r)
      (>= (- (battery-soc ?r) (put-down-battery)) (nearest-charger-battery ?l)))
    :effect (and
      (not (has-supplement ?r))
      (not (correct-supplement ?r))
      (not (wrong-supplement ?r))
      (not (supplement-is ?r ?s))
      (available ?s ?l)
      (decrease (battery-soc ?r) (put-down-battery))
      (increase (stage_cost) (+
        (* (w0) (put-down-time) (feature-per-second))
        (* (w2) (put-down-battery) (feature-per-charge))))
      (increase (total_time) (put-down-time))
      (increase (discrete_steps) 1)))

  ;; Delivery: both items, both found correct.

  (:action deliver_on_bedside_table_left
    :parameters (?r - robot)
    :precondition (and
      (at ?r patient_bed_left)
      (has-medication ?r)
      (has-supplement ?r)
      (correct-medication ?r)
      (correct-supplement ?r)
      (>= (battery-soc ?r) (deliver-battery)))
    :effect (and
      (delivered ?r)
      (not (has-medication ?r))
      (not (correct-medication ?r))
      (forall (?m - medicine) (not (medication-is ?r ?m)))
      (not (has-supplement ?r))
      (not (correct-supplement ?r))
      (forall (?s - supplement) (not (supplement-is ?r ?s)))
      (decrease (battery-soc ?r) (deliver-battery))
      (increase (stage_cost) (+
        (* (w0) (deliver-time) (feature-per-second))
        (* (w2) (deliver-battery) (feature-per-charge))
        (* (w3) (deliver-time) (standing-proximity patient_bed_left) (feature-per-discomfort))))
      (increase (total_time) (deliver-time))
      (increase (discrete_steps) 1)))

  (:action deliver_on_bedside_table_right
    :parameters (?r - robot)
    :precondition (and
      (at ?r patient_bed_right)
      (has-medication ?r)
      (has-supplement ?r)
      (correct-medication ?r)
      (correct-supplement ?r)
      (>= (battery-soc ?r) (deliver-battery)))
    :effect (and
      (delivered ?r)
      (not (has-medication ?r))
      (not (correct-medication ?r))
      (forall (?m - medicine) (not (medication-is ?r ?m)))
      (not (has-supplement ?r))
      (not (correct-supplement ?r))
      (forall (?s - supplement) (not (supplement-is ?r ?s)))
      (decrease (battery-soc ?r) (deliver-battery))
      (increase (stage_cost) (+
        (* (w0) (deliver-time) (feature-per-second))
        (* (w2) (deliver-battery) (feature-per-charge))
        (* (w3) (deliver-time) (standing-proximity patient_bed_right) (feature-per-discomfort))))
      (increase (total_time) (deliver-time))
      (increase (discrete_steps) 1)))

  (:action recharge
    :parameters (?r - robot ?c - charger)
    :precondition (at ?r ?c)
    :effect (and
      (assign (battery-soc ?r) 1.0)
      (increase (stage_cost) (* (w0) (recharge-time) (feature-per-second)))
      (increase (total_time) (recharge-time))
      (increase (discrete_steps) 1))))
