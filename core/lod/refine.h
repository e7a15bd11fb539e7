// The last touch of a level: where its vertices lie, and how its edges run.
#pragma once

#include "core/lod/draft.h"
#include "core/lod/full_surface.h"
#include "core/lod/simplify.h"
#include "core/progress.h"

namespace orbis::lod {

// Lowers the deviation of the level from the full surface, at its number of triangles: up to three rounds in which
// vertices move, in space and in the atlas (relocate), and edges of two triangles change to the other diagonal
// (flip_edges); then all positions are fitted together (fit_positions.h). Where the surface is cut for the atlas, or
// ends, vertices and edges keep their place in the atlas. Every triangle keeps its orientation in the atlas and on the
// sphere, exactly. Deterministic; O(triangles of the full surface). Throws Error{canceled}; reports nothing.
void refine(const FullSurface& full, Level& level, const Progress& progress);

// Each vertex inside a chart, one after the other: a step of Gauss and Newton's method in the five numbers (position,
// place in the atlas), halved until the deviation falls and no triangle around it folds or turns by more than 80
// degrees.
void relocate(Draft& draft, const Progress& progress);

// Edges between two triangles of one region change to the other diagonal of the two where that lowers the deviation,
// gives two sound triangles, and joins no two points that are joined already.
void flip_edges(Draft& draft);

} // namespace orbis::lod
