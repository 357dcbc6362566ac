"""The exact engine: from a `Slice` to a `RegionMap`, poses or ranges, by algebra.

A map, in `exactmap`, whose docstring lists the stages:

* `stages`: a slice as the engine reads it, its variety, and the counts at samples; `models` has
  the polynomial systems;
* `discriminant_variety`: the curves where counts may change, `continua` and `witness` what is
  wrong where they are everywhere;
* `decomposition`, on the algorithms in `cad`: cells, neighbours and regions;
* `point_system` and `counting`: the solutions at one rational point;
* `regionareas`: the areas of regions;
* `mapassembly` and `exactplan`: the `RegionMap`, and what is left out of its computation.

Other answers:

* `exactposes`, `statics`, `stiffness`: all equilibria at a point;
* `ranges`: ranges along lines, over slices, and of poses;
* `familyvariety`, `familyprojection`: what the members of a family have in common;
* `slicearrangement`: regions without areas, and the boundary between them over strips;
* `eliminationsystem`, `curvesizes`: the variety by itself, and its size before it is computed.
"""
