// A level's vertices moved to where its triangles are closest to the full surface.
#pragma once

#include "core/lod/deviation_quadric.h"
#include "core/lod/full_surface.h"
#include "core/lod/simplify.h"

namespace orbis::lod {

// The quadrics of the collapses know the full surface by the planes that met at a vertex. Here the integral itself is
// made small, over the full surface and with the level's triangulation and its places in the atlas as they are:
//
//   sum over samples i   a_i ( (1 - s_i) (n_i . r_i)^2 + s_i |r_i|^2 ),    r_i = sum_k w_ik p_k - P_i
//
// where the level's triangle at the sample's texel has its corners p_k and weights w_ik there. That is a linear system
// for the positions, solved by conjugate gradients; its matrix is a mass matrix, so that few steps do. Points that
// would go far, and those whose triangles would turn over, stay where they were.
void fit_positions(const FullSurface& full, Level& level);

} // namespace orbis::lod
