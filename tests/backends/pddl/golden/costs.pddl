; Emitted by cdlc from the CDL domain "costs".
; Costs are multiplied by 4 to be whole.
(define (domain costs)
  (:requirements :strips :typing :negative-preconditions :action-costs)
  (:types place)
  (:predicates
    (at ?p - place)
    (wet ?p - place)
    (road ?p ?q - place))
  (:functions
    (drive-cost ?p ?q - place)
    (total-cost) - number)
  (:action wait  ; r_wait
    :parameters (?p - place)
    :precondition (and)
    :effect (and
      (not (wet ?p))
      (increase (total-cost) 2)))
  (:action drive  ; r_drive
    :parameters (?p ?q - place)
    :precondition (and
      (at ?p)
      (road ?p ?q))
    :effect (and
      (not (at ?p))
      (at ?q)
      (increase (total-cost) (drive-cost ?p ?q))))
  (:action fly  ; r_fly
    :parameters (?p ?p-2 - place)
    :precondition (and
      (at ?p-2)
      (wet ?p))
    :effect (and
      (not (at ?p-2))
      (at ?p)
      (increase (total-cost) 40)))
  (:action r_fly  ; r_fly
    :parameters (?p ?p-2 - place)
    :precondition (and
      (at ?p-2)
      (not (wet ?p)))
    :effect (and
      (not (at ?p-2))
      (at ?p)
      (increase (total-cost) 16))))

; Emitted by cdlc from the CDL problem "costs".
(define (problem costs)
  (:domain costs)
  (:objects
    a b c - place)
  (:init
    (at a)
    (wet c)
    (road a b)
    (road b c)
    (= (drive-cost a a) 8)
    (= (drive-cost a b) 14)
    (= (drive-cost a c) 8)
    (= (drive-cost b a) 8)
    (= (drive-cost b b) 8)
    (= (drive-cost b c) 9)
    (= (drive-cost c a) 8)
    (= (drive-cost c b) 8)
    (= (drive-cost c c) 8)
    (= (total-cost) 0))
  (:goal (and
    (at c)))
  (:metric minimize (total-cost)))
