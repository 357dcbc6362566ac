"""The exact engine: from a `Slice` to a `RegionMap`, poses or ranges, by algebra.

A map, in `exactmap`, whose docstring lists the stages:

* `stages`: a slice as the engine reads it, its variety, and the counts at samples; `models` has
  the polynomial systems;
* `discriminant_variety`: the curves where counts may change, `continua` and `witness` what is
  wrong where they are everywhere;
* `cad`: cells, neighbours and regions, by `cad.decomposition`;
* `point_system` and `counting`: the solutions at one rational point;
* `areas`: the areas of regions;
* `mapassembly` and `exactplan`: the `RegionMap`, and what is left out of its computation.

Other answers:

* `exactposes`, `statics`, `stiffness`: all equilibria at a point;
* `ranges`: ranges along lines, over slices, and of poses;
* `familyvariety`, `familyprojection`: what the members of a family have in common;
* `slicearrangement`: regions without areas;
* `boundaries`: walls as polylines, and the boundary between regions over strips;
* `eliminationsystem`, `curvesizes`: the variety by itself, and its size before it is computed.
"""
