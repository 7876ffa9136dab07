; Emitted by cdlc from the CDL domain "numbers".
(define (domain numbers)
  (:requirements :strips :typing :negative-preconditions :disjunctive-preconditions :equality :universal-preconditions :conditional-effects :numeric-fluents :action-costs)
  (:types tank)
  (:predicates
    (open ?x - tank))
  (:functions
    (level ?x - tank)
    (capacity ?x - tank)
    (total)
    (total-cost) - number)
  (:action pour  ; r_pour
    :parameters (?x ?y - tank)
    :precondition (and
      (not (= ?x ?y))
      (not (<= (level ?x) 0))
      (not (>= (level ?y) (capacity ?y))))
    :effect (and
      (when (not (>= (- (capacity ?y) (level ?y)) (level ?x))) (decrease (level ?x) (- (capacity ?y) (level ?y))))
      (when (>= (- (capacity ?y) (level ?y)) (level ?x)) (decrease (level ?x) (level ?x)))
      (when (not (>= (- (capacity ?y) (level ?y)) (level ?x))) (increase (level ?y) (- (capacity ?y) (level ?y))))
      (when (>= (- (capacity ?y) (level ?y)) (level ?x)) (increase (level ?y) (level ?x)))
      (increase (total) 0.5)
      (increase (total-cost) 1)))
  (:action fill  ; fill
    :parameters (?x ?y - tank)
    :precondition (and)
    :effect (and
      (when (not (= ?x ?y)) (increase (level ?x) 1))
      (when (= ?x ?y) (increase (level ?y) 2))
      (when (not (= ?x ?y)) (increase (level ?y) 1))))
  (:action drop  ; drop
    :parameters (?x - tank)
    :precondition (and)
    :effect (and
      (when (and (not (<= (level ?x) 0)) (not (<= (level ?x) 1)) (not (<= (level ?x) 2))) (decrease (level ?x) 3))
      (when (and (not (<= (level ?x) 0)) (not (<= (level ?x) 1)) (<= (level ?x) 2)) (decrease (level ?x) 2))
      (when (and (not (<= (level ?x) 0)) (<= (level ?x) 1)) (decrease (level ?x) 1))))
  (:action leak  ; leak_all
    :parameters ()
    :precondition (and
      (forall (?t - tank) (or (>= (level ?t) 0) (open ?t))))
    :effect (and
      (forall (?x - tank) (when (and (open ?x) (not (<= (level ?x) 2))) (decrease (level ?x) 2)))
      (forall (?x - tank) (when (and (open ?x) (<= (level ?x) 2)) (assign (level ?x) 0)))
      (when (not (>= (total) 0)) (assign (total) (- (* (total) 2) (* -1 (total)))))
      (when (>= (total) 0) (assign (total) (- (* (total) 2) (total))))
      (increase (total-cost) 1))))

; Emitted by cdlc from the CDL problem "numbers".
(define (problem numbers)
  (:domain numbers)
  (:objects
    a b - tank)
  (:init
    (= (level a) 3)
    (= (level b) 0)
    (= (capacity a) 5)
    (= (capacity b) 5)
    (= (total) -1.5)
    (= (total-cost) 0))
  (:goal (and
    (= (level b) 3)
    (not (= (level a) 3))
    (<= (total) 2)))
  (:metric minimize (total-cost)))
