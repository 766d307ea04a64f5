// SPDX-License-Identifier: GPL-3.0-or-later
//
// Everything that can be asked of a terrain, and what is done with results: class Terrain, all
// requests and results, polygons between levels (isoline/isoline_bands.h), lines cut at a window
// (isoline/isoline_clip.h), isolines of a mesh that grows (isoline/isoline_progressive.h), the
// receiver of a stream (stream/stream_reader.h), and questions of the mesh that it received
// (received/received_mesh.h). Who asks one question includes terrain.h and the header of the
// question.
#pragma once

#include "engine/query/heights/class_changes.h"
#include "engine/query/heights/highest.h"
#include "engine/query/heights/locate.h"
#include "engine/query/heights/profile.h"
#include "engine/query/isoline/isoline.h"
#include "engine/query/isoline/isoline_bands.h"
#include "engine/query/isoline/isoline_clip.h"
#include "engine/query/isoline/isoline_progressive.h"
#include "engine/query/living/tin_parts.h"
#include "engine/query/raster/pixel_sampler.h"
#include "engine/query/raster/raster.h"
#include "engine/query/raster/scattered_pixels.h"
#include "engine/query/received/received_mesh.h"
#include "engine/query/refine/hierarchy_check.h"
#include "engine/query/refine/moving_window.h"
#include "engine/query/refine/refine.h"
#include "engine/query/select/detail.h"
#include "engine/query/select/opened_terrain.h"
#include "engine/query/select/predicate.h"
#include "engine/query/select/query_limits.h"
#include "engine/query/sight/sight.h"
#include "engine/query/sight/viewshed.h"
#include "engine/query/stream/stream_reader.h"
#include "engine/query/stream/stream_writer.h"
#include "engine/query/terrain.h"
#include "engine/query/volume/volume.h"
