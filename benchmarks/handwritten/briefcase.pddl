(define (domain briefcase)
  (:requirements :adl)
  (:types item place)
  (:constants home office - place)
  (:predicates
    (briefcase_at ?p - place)
    (at ?x - item ?p - place)
    (inside ?x - item))
  (:action carry
    :parameters (?from ?to - place)
    :precondition (and (briefcase_at ?from) (not (= ?from ?to)))
    :effect (and
      (briefcase_at ?to)
      (not (briefcase_at ?from))
      (forall (?x - item) (when (inside ?x) (at ?x ?to)))
      (forall (?x - item ?p - place) (when (and (inside ?x) (at ?x ?p)) (not (at ?x ?p))))))
  (:action put_in
    :parameters (?x - item ?p - place)
    :precondition (and (at ?x ?p) (briefcase_at ?p))
    :effect (inside ?x))
  (:action take_out
    :parameters (?x - item)
    :precondition (and)
    :effect (not (inside ?x))))
