; Emitted by cdlc from the CDL domain "domain".
(define (domain domain)
  (:requirements :strips :typing)
  (:types block)
  (:predicates
    (clear ?x - block)
    (on ?x ?y - block)
    (on_table ?x - block)
    (holding ?x - block)
    (handempty))
  (:action pickup_table  ; r_holding_from_table
    :parameters (?x - block)
    :precondition (and
      (on_table ?x)
      (clear ?x)
      (handempty))
    :effect (and
      (not (clear ?x))
      (not (handempty))
      (not (on_table ?x))
      (holding ?x)))
  (:action unstack  ; r_holding_from_stack, r_clear
    :parameters (?x ?y - block)
    :precondition (and
      (on ?x ?y)
      (clear ?x)
      (handempty))
    :effect (and
      (not (clear ?x))
      (not (handempty))
      (not (on ?x ?y))
      (holding ?x)
      (clear ?y)))
  (:action place_table  ; r_clear_from_holding, r_handempty, r_on_table
    :parameters (?x - block)
    :precondition (and
      (holding ?x))
    :effect (and
      (not (holding ?x))
      (clear ?x)
      (handempty)
      (on_table ?x)))
  (:action stack  ; r_on
    :parameters (?x ?y - block)
    :precondition (and
      (clear ?y)
      (holding ?x))
    :effect (and
      (not (clear ?y))
      (not (holding ?x))
      (on ?x ?y)
      (clear ?x)
      (handempty))))

; Emitted by cdlc from the CDL problem "sussman".
(define (problem sussman)
  (:domain domain)
  (:objects
    A B C - block)
  (:init
    (clear B)
    (clear C)
    (on C A)
    (on_table A)
    (on_table B)
    (handempty))
  (:goal (and
    (on A B)
    (on B C))))
