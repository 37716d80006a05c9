;; Meal preparation: a care robot chooses one of three dishes, fetches its two ingredients, prepares the dish under the
;; rules of hygiene and cooking, and delivers it on a bedside table.
;;
;; Units: seconds, metres, radians; charge is the state of charge in [0, 1]. Every number that depends on the ward is a
;; fluent of the problem. Stage cost of an action: w' f, where the weights w0 ... w4 say what matters to the patient and
;; f = (time, safety, battery, proximity, approach) is scaled, so that whole meals have features between 0 and 1. The
;; approach feature of a meal is that of the bedside plus how far the dish's looks are from the best.
;;
;; What has been done to the ingredients is true of those in the gripper: with a lost one it is undone. Ways lead in one
;; direction: from the stores to the preparation station, from there by the stove or straight to the quality check, and
;; on to the bed. Whoever has to go back goes by a charger.

(define (domain meal_preparation)
  (:requirements :strips :typing :negative-preconditions :disjunctive-preconditions :numeric-fluents
    :conditional-effects :universal-preconditions :existential-preconditions)

  (:types
    robot location meal ingredient - object
    kitchen charger bedside - location)

  (:constants
    pantry fridge prep_station stove quality_check - kitchen
    charge_main charge_backup - charger
    patient_bed_left patient_bed_right - bedside
    sandwich salad hot_meal - meal
    bread nuts vegetables chicken - ingredient)

  (:predicates
    (at ?r - robot ?l - location)
    (connected ?from ?to - location)                    ; a way of the task that has not been found blocked
    (ingredient_available ?i - ingredient ?l - location) ; in stock, as observed: plans do not count what they take
    (requires_cooking ?m - meal)
    (meal_to_prepare ?r - robot ?m - meal)
    (missing_ingredient ?r - robot ?i - ingredient)     ; needed for the dish and not in the gripper
    (collected_ingredient ?r - robot ?i - ingredient)   ; in the gripper
    ;; Of the ingredients in the gripper.
    (ingredients_checked ?r - robot)
    (ingredients_safe ?r - robot)
    (ingredients_washed ?r - robot)
    (ingredients_chopped ?r - robot)
    (meal_cooked ?r - robot)
    (cooking_level_checked ?r - robot)
    (meal_palatable ?r - robot)
    (meal_assembled ?r - robot)
    ;; Hygiene.
    (workspace-clean)
    (robot-hands-clean ?r - robot)
    (cross-contamination-risk)                          ; something unwashed or raw has been handled
    (can_be_deliverable ?r - robot)                     ; the finished dish is at a bedside
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
    (presentation-error ?m - meal)                 ; how far the dish's looks are from the best, in units of approach
    ;; Actions at a place: seconds, and charge used.
    (choose-time) (collect-ingredient-time) (check-ingredients-time) (sanitize-time) (wash-time) (chop-time)
    (cook-time) (check-cooking-level-time) (check-palatability-time) (assemble-time ?m - meal) (serve-time)
    (recharge-time)
    (choose-battery) (collect-ingredient-battery) (check-ingredients-battery) (sanitize-battery) (wash-battery)
    (chop-battery) (cook-battery) (check-cooking-level-battery) (check-palatability-battery)
    (assemble-battery ?m - meal) (serve-battery)
    ;; How much of a scaled feature one unit is.
    (feature-per-second) (feature-per-risk) (feature-per-charge) (feature-per-discomfort) (feature-per-error)
    ;; Preference weights.
    (w0) (w1) (w2) (w3) (w4)
    (terminal-weight)
    ;; Accumulated by the actions.
    (stage_cost)
    (total_time)                                   ; seconds
    (discrete_steps))

  ;; The dish. Another one can be chosen as long as nothing in the gripper belongs to the first one alone.

  (:action choose_sandwich
    :parameters (?r - robot)
    :precondition (and
      (not (meal_to_prepare ?r sandwich))
      (not (collected_ingredient ?r nuts))
      (not (collected_ingredient ?r chicken))
      (not (delivered ?r)))
    :effect (and
      (meal_to_prepare ?r sandwich)
      (not (meal_to_prepare ?r salad))
      (not (meal_to_prepare ?r hot_meal))
      (not (missing_ingredient ?r nuts))
      (not (missing_ingredient ?r chicken))
      (when (not (collected_ingredient ?r bread)) (missing_ingredient ?r bread))
      (when (not (collected_ingredient ?r vegetables)) (missing_ingredient ?r vegetables))
      (decrease (battery-soc ?r) (choose-battery))
      (increase (stage_cost) (+
        (* (w0) (choose-time) (feature-per-second))
        (* (w2) (choose-battery) (feature-per-charge))))
      (increase (total_time) (choose-time))
      (increase (discrete_steps) 1)))

  (:action choose_salad
    :parameters (?r - robot)
    :precondition (and
      (not (meal_to_prepare ?r salad))
      (not (collected_ingredient ?r bread))
      (not (collected_ingredient ?r chicken))
      (not (delivered ?r)))
    :effect (and
      (meal_to_prepare ?r salad)
      (not (meal_to_prepare ?r sandwich))
      (not (meal_to_prepare ?r hot_meal))
      (not (missing_ingredient ?r bread))
      (not (missing_ingredient ?r chicken))
      (when (not (collected_ingredient ?r nuts)) (missing_ingredient ?r nuts))
      (when (not (collected_ingredient ?r vegetables)) (missing_ingredient ?r vegetables))
      (decrease (battery-soc ?r) (choose-battery))
      (increase (stage_cost) (+
        (* (w0) (choose-time) (feature-per-second))
        (* (w2) (choose-battery) (feature-per-charge))))
      (increase (total_time) (choose-time))
      (increase (discrete_steps) 1)))

  (:action choose_hot_meal
    :parameters (?r - robot)
    :precondition (and
      (not (meal_to_prepare ?r hot_meal))
      (not (collected_ingredient ?r bread))
      (not (collected_ingredient ?r nuts))
      (not (delivered ?r)))
    :effect (and
      (meal_to_prepare ?r hot_meal)
      (not (meal_to_prepare ?r sandwich))
      (not (meal_to_prepare ?r salad))
      (not (missing_ingredient ?r bread))
      (not (missing_ingredient ?r nuts))
      (when (not (collected_ingredient ?r chicken)) (missing_ingredient ?r chicken))
      (when (not (collected_ingredient ?r vegetables)) (missing_ingredient ?r vegetables))
      (decrease (battery-soc ?r) (choose-battery))
      (increase (stage_cost) (+
        (* (w0) (choose-time) (feature-per-second))
        (* (w2) (choose-battery) (feature-per-charge))))
      (increase (total_time) (choose-time))
      (increase (discrete_steps) 1)))

  ;; Movements. The charge after a move must suffice to reach the nearest charger from there; arriving low costs extra.
  ;; Who goes for ingredients knows what for.

  (:action go_to_pantry
    :parameters (?r - robot ?from - location)
    :precondition (and
      (at ?r ?from)
      (connected ?from pantry)
      (exists (?m - meal) (meal_to_prepare ?r ?m))
      (>= (- (battery-soc ?r) (nav-battery ?from pantry)) (nearest-charger-battery pantry)))
    :effect (and
      (not (at ?r ?from))
      (at ?r pantry)
      (decrease (battery-soc ?r) (nav-battery ?from pantry))
      (increase (stage_cost) (+
        (* (w0) (nav-time ?from pantry) (feature-per-second))
        (* (w1) (location-safety ?from pantry) (feature-per-risk))
        (* (w2) (nav-charge ?from pantry) (feature-per-charge))
        (* (w3) (proximity-feature ?from pantry) (feature-per-discomfort))))
      (when (< (- (battery-soc ?r) (nav-battery ?from pantry)) 0.15) (increase (stage_cost) (* (w2) 0.5)))
      (when (< (- (battery-soc ?r) (nav-battery ?from pantry)) 0.25) (increase (stage_cost) (* (w2) 0.2)))
      (increase (total_time) (nav-time ?from pantry))
      (increase (discrete_steps) 1)))

  (:action go_to_fridge
    :parameters (?r - robot ?from - location)
    :precondition (and
      (at ?r ?from)
      (connected ?from fridge)
      (exists (?m - meal) (meal_to_prepare ?r ?m))
      (>= (- (battery-soc ?r) (nav-battery ?from fridge)) (nearest-charger-battery fridge)))
    :effect (and
      (not (at ?r ?from))
      (at ?r fridge)
      (decrease (battery-soc ?r) (nav-battery ?from fridge))
      (increase (stage_cost) (+
        (* (w0) (nav-time ?from fridge) (feature-per-second))
        (* (w1) (location-safety ?from fridge) (feature-per-risk))
        (* (w2) (nav-charge ?from fridge) (feature-per-charge))
        (* (w3) (proximity-feature ?from fridge) (feature-per-discomfort))))
      (when (< (- (battery-soc ?r) (nav-battery ?from fridge)) 0.15) (increase (stage_cost) (* (w2) 0.5)))
      (when (< (- (battery-soc ?r) (nav-battery ?from fridge)) 0.25) (increase (stage_cost) (* (w2) 0.2)))
      (increase (total_time) (nav-time ?from fridge))
      (increase (discrete_steps) 1)))

  (:action go_to_prep_station
    :parameters (?r - robot ?from - location)
    :precondition (and
      (at ?r ?from)
      (connected ?from prep_station)
      (>= (- (battery-soc ?r) (nav-battery ?from prep_station)) (nearest-charger-battery prep_station)))
    :effect (and
      (not (at ?r ?from))
      (at ?r prep_station)
      (decrease (battery-soc ?r) (nav-battery ?from prep_station))
      (increase (stage_cost) (+
        (* (w0) (nav-time ?from prep_station) (feature-per-second))
        (* (w1) (location-safety ?from prep_station) (feature-per-risk))
        (* (w2) (nav-charge ?from prep_station) (feature-per-charge))
        (* (w3) (proximity-feature ?from prep_station) (feature-per-discomfort))))
      (when (< (- (battery-soc ?r) (nav-battery ?from prep_station)) 0.15) (increase (stage_cost) (* (w2) 0.5)))
      (when (< (- (battery-soc ?r) (nav-battery ?from prep_station)) 0.25) (increase (stage_cost) (* (w2) 0.2)))
      (increase (total_time) (nav-time ?from prep_station))
      (increase (discrete_steps) 1)))

  (:action go_to_cooking_station
    :parameters (?r - robot ?from - location)
    :precondition (and
      (at ?r ?from)
      (connected ?from stove)
      (>= (- (battery-soc ?r) (nav-battery ?from stove)) (nearest-charger-battery stove)))
    :effect (and
      (not (at ?r ?from))
      (at ?r stove)
      (decrease (battery-soc ?r) (nav-battery ?from stove))
      (increase (stage_cost) (+
        (* (w0) (nav-time ?from stove) (feature-per-second))
        (* (w1) (location-safety ?from stove) (feature-per-risk))
        (* (w2) (nav-charge ?from stove) (feature-per-charge))
        (* (w3) (proximity-feature ?from stove) (feature-per-discomfort))))
      (when (< (- (battery-soc ?r) (nav-battery ?from stove)) 0.15) (increase (stage_cost) (* (w2) 0.5)))
      (when (< (- (battery-soc ?r) (nav-battery ?from stove)) 0.25) (increase (stage_cost) (* (w2) 0.2)))
      (increase (total_time) (nav-time ?from stove))
      (increase (discrete_steps) 1)))

  (:action go_to_quality_check
    :parameters (?r - robot ?from - location)
    :precondition (and
      (at ?r ?from)
      (connected ?from quality_check)
      (>= (- (battery-soc ?r) (nav-battery ?from quality_check)) (nearest-charger-battery quality_check)))
    :effect (and
      (not (at ?r ?from))
      (at ?r quality_check)
      (decrease (battery-soc ?r) (nav-battery ?from quality_check))
      (increase (stage_cost) (+
        (* (w0) (nav-time ?from quality_check) (feature-per-second))
        (* (w1) (location-safety ?from quality_check) (feature-per-risk))
        (* (w2) (nav-charge ?from quality_check) (feature-per-charge))
        (* (w3) (proximity-feature ?from quality_check) (feature-per-discomfort))))
      (when (< (- (battery-soc ?r) (nav-battery ?from quality_check)) 0.15) (increase (stage_cost) (* (w2) 0.5)))
      (when (< (- (battery-soc ?r) (nav-battery ?from quality_check)) 0.25) (increase (stage_cost) (* (w2) 0.2)))
      (increase (total_time) (nav-time ?from quality_check))
      (increase (discrete_steps) 1)))

  (:action go_to_charge_main
    :parameters (?r - robot ?from - location)
    :precondition (and
      (at ?r ?from)
      (connected ?from charge_main)
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
      (connected ?from charge_backup)
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

  ;; To the bed with a finished dish only. The charge left there must suffice for the delivery, too.

  (:action approach_to_left_side
    :parameters (?r - robot ?from - location)
    :precondition (and
      (at ?r ?from)
      (connected ?from patient_bed_left)
      (meal_palatable ?r)
      (meal_assembled ?r)
      (>= (- (battery-soc ?r) (nav-battery ?from patient_bed_left))
        (+ (nearest-charger-battery patient_bed_left) (serve-battery))))
    :effect (and
      (not (at ?r ?from))
      (at ?r patient_bed_left)
      (can_be_deliverable ?r)
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

  (:action approach_to_right_side
    :parameters (?r - robot ?from - location)
    :precondition (and
      (at ?r ?from)
      (connected ?from patient_bed_right)
      (meal_palatable ?r)
      (meal_assembled ?r)
      (>= (- (battery-soc ?r) (nav-battery ?from patient_bed_right))
        (+ (nearest-charger-battery patient_bed_right) (serve-battery))))
    :effect (and
      (not (at ?r ?from))
      (at ?r patient_bed_right)
      (can_be_deliverable ?r)
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

  ;; Ingredients. Whoever touches what is unwashed has to clean up before going on.

  (:action collect_ingredient
    :parameters (?r - robot ?l - kitchen ?i - ingredient)
    :precondition (and
      (at ?r ?l)
      (ingredient_available ?i ?l)
      (missing_ingredient ?r ?i)
      (>= (- (battery-soc ?r) (collect-ingredient-battery)) (nearest-charger-battery ?l)))
    :effect (and
      (collected_ingredient ?r ?i)
      (not (missing_ingredient ?r ?i))
      (not (robot-hands-clean ?r))
      (cross-contamination-risk)
      (decrease (battery-soc ?r) (collect-ingredient-battery))
      (increase (stage_cost) (+
        (* (w0) (collect-ingredient-time) (feature-per-second))
        (* (w2) (collect-ingredient-battery) (feature-per-charge))))
      (increase (total_time) (collect-ingredient-time))
      (increase (discrete_steps) 1)))

  (:action check_ingredients
    :parameters (?r - robot ?m - meal)
    :precondition (and
      (at ?r prep_station)
      (meal_to_prepare ?r ?m)
      (forall (?i - ingredient) (not (missing_ingredient ?r ?i)))
      (not (ingredients_checked ?r))
      (>= (- (battery-soc ?r) (check-ingredients-battery)) (nearest-charger-battery prep_station)))
    :effect (and
      (ingredients_checked ?r)
      (ingredients_safe ?r)
      (decrease (battery-soc ?r) (check-ingredients-battery))
      (increase (stage_cost) (+
        (* (w0) (check-ingredients-time) (feature-per-second))
        (* (w2) (check-ingredients-battery) (feature-per-charge))))
      (increase (total_time) (check-ingredients-time))
      (increase (discrete_steps) 1)))

  (:action sanitize_workspace
    :parameters (?r - robot)
    :precondition (and
      (at ?r prep_station)
      (ingredients_checked ?r)
      (cross-contamination-risk)
      (not (ingredients_washed ?r))
      (>= (- (battery-soc ?r) (sanitize-battery)) (nearest-charger-battery prep_station)))
    :effect (and
      (workspace-clean)
      (robot-hands-clean ?r)
      (not (cross-contamination-risk))
      (decrease (battery-soc ?r) (sanitize-battery))
      (increase (stage_cost) (+
        (* (w0) (sanitize-time) (feature-per-second))
        (* (w2) (sanitize-battery) (feature-per-charge))))
      (increase (total_time) (sanitize-time))
      (increase (discrete_steps) 1)))

  ;; Preparation: on a clean workspace with clean hands. Chopping soils the workspace; what has to be cooked is raw, and
  ;; a risk until it has been cooked.

  (:action wash_ingredients
    :parameters (?r - robot)
    :precondition (and
      (at ?r prep_station)
      (ingredients_checked ?r)
      (ingredients_safe ?r)
      (workspace-clean)
      (robot-hands-clean ?r)
      (not (cross-contamination-risk))
      (not (ingredients_washed ?r))
      (>= (- (battery-soc ?r) (wash-battery)) (nearest-charger-battery prep_station)))
    :effect (and
      (ingredients_washed ?r)
      (decrease (battery-soc ?r) (wash-battery))
      (increase (stage_cost) (+
        (* (w0) (wash-time) (feature-per-second))
        (* (w2) (wash-battery) (feature-per-charge))))
      (increase (total_time) (wash-time))
      (increase (discrete_steps) 1)))

  (:action chop_ingredients
    :parameters (?r - robot ?m - meal)
    :precondition (and
      (at ?r prep_station)
      (meal_to_prepare ?r ?m)
      (ingredients_washed ?r)
      (workspace-clean)
      (robot-hands-clean ?r)
      (not (ingredients_chopped ?r))
      (>= (- (battery-soc ?r) (chop-battery)) (nearest-charger-battery prep_station)))
    :effect (and
      (ingredients_chopped ?r)
      (not (workspace-clean))
      (when (requires_cooking ?m) (cross-contamination-risk))
      (decrease (battery-soc ?r) (chop-battery))
      (increase (stage_cost) (+
        (* (w0) (chop-time) (feature-per-second))
        (* (w2) (chop-battery) (feature-per-charge))))
      (increase (total_time) (chop-time))
      (increase (discrete_steps) 1)))

  (:action cook_meal
    :parameters (?r - robot ?m - meal)
    :precondition (and
      (at ?r stove)
      (meal_to_prepare ?r ?m)
      (requires_cooking ?m)
      (ingredients_chopped ?r)
      (not (meal_cooked ?r))
      (>= (- (battery-soc ?r) (cook-battery)) (nearest-charger-battery stove)))
    :effect (and
      (meal_cooked ?r)
      (not (cross-contamination-risk))
      (decrease (battery-soc ?r) (cook-battery))
      (increase (stage_cost) (+
        (* (w0) (cook-time) (feature-per-second))
        (* (w2) (cook-battery) (feature-per-charge))))
      (increase (total_time) (cook-time))
      (increase (discrete_steps) 1)))

  (:action check_cooking_level
    :parameters (?r - robot)
    :precondition (and
      (at ?r stove)
      (meal_cooked ?r)
      (not (cooking_level_checked ?r))
      (>= (- (battery-soc ?r) (check-cooking-level-battery)) (nearest-charger-battery stove)))
    :effect (and
      (cooking_level_checked ?r)
      (decrease (battery-soc ?r) (check-cooking-level-battery))
      (increase (stage_cost) (+
        (* (w0) (check-cooking-level-time) (feature-per-second))
        (* (w2) (check-cooking-level-battery) (feature-per-charge))))
      (increase (total_time) (check-cooking-level-time))
      (increase (discrete_steps) 1)))

  ;; Tasting and assembling, at the quality check.

  (:action check_palatability
    :parameters (?r - robot ?m - meal)
    :precondition (and
      (at ?r quality_check)
      (meal_to_prepare ?r ?m)
      (ingredients_chopped ?r)
      (or (not (requires_cooking ?m)) (cooking_level_checked ?r))
      (not (cross-contamination-risk))
      (not (meal_palatable ?r))
      (>= (- (battery-soc ?r) (check-palatability-battery)) (nearest-charger-battery quality_check)))
    :effect (and
      (meal_palatable ?r)
      (decrease (battery-soc ?r) (check-palatability-battery))
      (increase (stage_cost) (+
        (* (w0) (check-palatability-time) (feature-per-second))
        (* (w2) (check-palatability-battery) (feature-per-charge))))
      (increase (total_time) (check-palatability-time))
      (increase (discrete_steps) 1)))

  (:action assemble
    :parameters (?r - robot ?m - meal)
    :precondition (and
      (at ?r quality_check)
      (meal_to_prepare ?r ?m)
      (meal_palatable ?r)
      (robot-hands-clean ?r)
      (not (meal_assembled ?r))
      (>= (- (battery-soc ?r) (assemble-battery ?m)) (nearest-charger-battery quality_check)))
    :effect (and
      (meal_assembled ?r)
      (decrease (battery-soc ?r) (assemble-battery ?m))
      (increase (stage_cost) (+
        (* (w0) (assemble-time ?m) (feature-per-second))
        (* (w2) (assemble-battery ?m) (feature-per-charge))
        (* (w4) (presentation-error ?m) (feature-per-error))))
      (increase (total_time) (assemble-time ?m))
      (increase (discrete_steps) 1)))

  ;; Delivery.

  (:action deliver_on_bedside_table_left
    :parameters (?r - robot ?m - meal)
    :precondition (and
      (at ?r patient_bed_left)
      (meal_to_prepare ?r ?m)
      (can_be_deliverable ?r)
      (meal_palatable ?r)
      (meal_assembled ?r)
      (>= (battery-soc ?r) (serve-battery)))
    :effect (and
      (delivered ?r)
      (not (can_be_deliverable ?r))
      (forall (?i - ingredient) (not (collected_ingredient ?r ?i)))
      (decrease (battery-soc ?r) (serve-battery))
      (increase (stage_cost) (+
        (* (w0) (serve-time) (feature-per-second))
        (* (w2) (serve-battery) (feature-per-charge))
        (* (w3) (serve-time) (standing-proximity patient_bed_left) (feature-per-discomfort))))
      (increase (total_time) (serve-time))
      (increase (discrete_steps) 1)))

  (:action deliver_on_bedside_table_right
    :parameters (?r - robot ?m - meal)
    :precondition (and
      (at ?r patient_bed_right)
      (meal_to_prepare ?r ?m)
      (can_be_deliverable ?r)
      (meal_palatable ?r)
      (meal_assembled ?r)
      (>= (battery-soc ?r) (serve-battery)))
    :effect (and
      (delivered ?r)
      (not (can_be_deliverable ?r))
      (forall (?i - ingredient) (not (collected_ingredient ?r ?i)))
      (decrease (battery-soc ?r) (serve-battery))
      (increase (stage_cost) (+
        (* (w0) (serve-time) (feature-per-second))
        (* (w2) (serve-battery) (feature-per-charge))
        (* (w3) (serve-time) (standing-proximity patient_bed_right) (feature-per-discomfort))))
      (increase (total_time) (serve-time))
      (increase (discrete_steps) 1)))

  (:action recharge
    :parameters (?r - robot ?c - charger)
    :precondition (at ?r ?c)
    :effect (and
      (assign (battery-soc ?r) 1.0)
      (increase (stage_cost) (* (w0) (recharge-time) (feature-per-second)))
      (increase (total_time) (recharge-time))
      (increase (discrete_steps) 1))))
