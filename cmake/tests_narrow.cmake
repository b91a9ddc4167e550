# Tests of the narrow phase. CGAL's exact kernel (gmp, mpfr) and boost::multiprecision are oracles.
collision_pairs_test(closed_forms)
collision_pairs_test(convex_distance)
collision_pairs_test(fcl_regressions)
collision_pairs_test(mesh_query gmp mpfr)
collision_pairs_test(narrow_phase)
collision_pairs_test(narrow_phase_extremes)
