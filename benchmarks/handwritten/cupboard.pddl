(define (domain cupboard)
  (:requirements :adl)
  (:types cup - item cupboard item place - object)
  (:constants table - place)
  (:predicates
    (loc ?x - item ?p - place)
    (shelf_for ?x - item ?c - cupboard ?p - place)
    (inside ?p - place ?c - cupboard)
    (blocked ?p - place)
    (opened ?c - cupboard)
    (holding ?x - item)
    (handempty))
  (:action open_door
    :parameters (?c - cupboard)
    :precondition (handempty)
    :effect (opened ?c))
  (:action close_door
    :parameters (?c - cupboard)
    :precondition (handempty)
    :effect (not (opened ?c)))
  (:action pick
    :parameters (?x - item ?p - place)
    :precondition (and
      (handempty) (loc ?x ?p)
      (forall (?c - cupboard) (or (not (inside ?p ?c)) (opened ?c))))
    :effect (and (holding ?x) (not (handempty)) (not (blocked ?p))))
  (:action place
    :parameters (?x - item ?from ?to - place)
    :precondition (and
      (holding ?x) (loc ?x ?from) (not (blocked ?to))
      (forall (?c - cupboard) (or (not (inside ?to ?c)) (opened ?c))))
    :effect (and
      (not (holding ?x)) (handempty)
      (not (loc ?x ?from)) (loc ?x ?to)
      (when (not (= ?to table)) (blocked ?to))))
  (:action put_away
    :parameters (?x - item ?from - place)
    :precondition (and (holding ?x) (loc ?x ?from))
    :effect (and (not (holding ?x)) (handempty) (not (loc ?x ?from)) (loc ?x table))))
