; Emitted by cdlc from the CDL domain "domain".
(define (domain domain)
  (:requirements :strips :typing :negative-preconditions :universal-preconditions :numeric-fluents)
  (:types room door)
  (:predicates
    (at ?r - room)
    (near ?r ?s - room)
    (joins ?d - door ?r - room)
    (key ?r - room)
    (tired)
    (oiled ?d - door)
    (opened ?d - door)
    (place ?value - room)
    (open_door-1 ?d - door ?r - room)
    (open_door-2 ?d - door))
  (:functions
    (oil)
    (open_door-2-left ?d - door))
  (:action walk  ; go
    :parameters (?r ?s - room)
    :precondition (and
      (near ?r ?s)
      (at ?r))
    :effect (and
      (not (at ?r))
      (at ?s)
      (tired)
      (increase (oil) 1)))
  (:action unlock  ; open_door
    :parameters (?d - door ?k ?r - room)
    :precondition (and
      (key ?k)
      (at ?k)
      (joins ?d ?r)
      (not (open_door-1 ?d ?r)))
    :effect (and
      (open_door-1 ?d ?r)))
  (:action push  ; open_door
    :parameters (?d - door ?r - room)
    :precondition (and
      (open_door-1 ?d ?r)
      (at ?r)
      (not (open_door-2 ?d)))
    :effect (and
      (not (open_door-1 ?d ?r))
      (open_door-2 ?d)
      (assign (open_door-2-left ?d) (oil))))
  (:action drip  ; open_door
    :parameters (?d - door)
    :precondition (and
      (open_door-2 ?d)
      (tired))
    :effect (and
      (not (open_door-2 ?d))
      (opened ?d)
      (assign (oil) (- (open_door-2-left ?d) 1)))))

; Emitted by cdlc from the CDL problem "doors".
(define (problem doors)
  (:domain domain)
  (:objects
    a b c - room
    d e - door)
  (:init
    (= (oil) 0)
    (at a)
    (near a b)
    (near b a)
    (near b c)
    (near c b)
    (joins d c)
    (joins e a)
    (key b)
    (place a)
    (= (open_door-2-left d) 0)
    (= (open_door-2-left e) 0))
  (:goal (and
    (opened d)
    (opened e)
    (forall (?d - door ?r - room) (not (open_door-1 ?d ?r)))
    (forall (?d - door) (not (open_door-2 ?d))))))
