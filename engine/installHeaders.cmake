# SPDX-License-Identifier: GPL-3.0-or-later
#
# The public headers: what another program may include. Run at installation, this file copies them from SOURCE into
# INCLUDE_FOLDER/ptin. All other headers are how a room works inside. `tests/layering` reads the list: tools and the test of
# the installation include nothing else, and a public header includes public headers alone.
cmake_policy(VERSION 3.25)
set(public_headers
    engine/check.h
    engine/construct/build.h
    engine/construct/build_observer.h
    engine/construct/build_options.h
    engine/construct/build_plan.h
    engine/construct/grid/decimal.h
    engine/construct/grid/source_disk.h
    engine/construct/grid/source_options.h
    engine/construct/grid/source_point.h
    engine/construct/hierarchy/stage_progress.h
    engine/construct/hierarchy/tile_bytes.h
    engine/construct/memory_plan.h
    engine/construct/points/open_points.h
    engine/construct/process_limits.h
    engine/construct/read/column_names.h
    engine/construct/read/input_kind.h
    engine/construct/read/point_stream.h
    engine/construct/scratch/external_memory.h
    engine/construct/scratch/external_sorter.h
    engine/construct/scratch/manifest.h
    engine/construct/scratch/run_merger.h
    engine/construct/scratch/workspace.h
    engine/construct/collapse/cost.h
    engine/construct/tile/tile_tree.h
    engine/crs/crs_facts.h
    engine/crs/ground.h
    engine/error.h
    engine/geometry/affine.h
    engine/geometry/box.h
    engine/geometry/convex_hull.h
    engine/geometry/height.h
    engine/geometry/hilbert.h
    engine/geometry/interval.h
    engine/geometry/key_table.h
    engine/geometry/orient.h
    engine/geometry/point.h
    engine/large_array.h
    engine/memory_units.h
    engine/mesh/star.h
    engine/mesh/tin.h
    engine/mesh/validate.h
    engine/prefetch.h
    engine/query/heights/highest.h
    engine/query/heights/locate.h
    engine/query/heights/profile.h
    engine/query/isoline/isoline.h
    engine/query/isoline/isoline_bands.h
    engine/query/isoline/isoline_clip.h
    engine/query/isoline/isoline_crossings.h
    engine/query/isoline/isoline_cut.h
    engine/query/isoline/isoline_pieces.h
    engine/query/isoline/isoline_progressive.h
    engine/query/isoline/isoline_trace.h
    engine/query/isoline/levels.h
    engine/query/isoline/point_store.h
    engine/query/refine/moving_window.h
    engine/query/refine/page_cache.h
    engine/query/refine/part_refiner.h
    engine/query/refine/refine.h
    engine/query/refine/refinement.h
    engine/query/select/accounting.h
    engine/query/select/certificate.h
    engine/query/select/detail.h
    engine/query/select/opened_terrain.h
    engine/query/select/predicate.h
    engine/query/select/query_limits.h
    engine/query/select/region.h
    engine/query/select/retrieval.h
    engine/query/select/total_order.h
    engine/query/sight/curvature.h
    engine/query/sight/sight.h
    engine/query/sight/viewshed.h
    engine/query/stream/range_coder.h
    engine/query/stream/split_code.h
    engine/query/stream/stream_format.h
    engine/query/stream/stream_reader.h
    engine/query/stream/stream_writer.h
    engine/query/terrain.h
    engine/query/walk/point_state.h
    engine/stop.h
    storage/attributes.h
    storage/file/file_layer.h
    storage/file/file_questions.h
    storage/file/io_counters.h
    storage/file/sigbus_guard.h
    storage/index.h
    storage/index_shape.h
    storage/layout.h
    storage/page_journal.h
    storage/page_store.h
    storage/record.h
    storage/spatialindex_rtree.h
    storage/store_file.h
    storage/store_writer.h
    storage/verify.h)

cmake_path(ABSOLUTE_PATH INCLUDE_FOLDER BASE_DIRECTORY "${CMAKE_INSTALL_PREFIX}")
foreach(header IN LISTS public_headers)
  get_filename_component(folder ${header} DIRECTORY)
  file(INSTALL DESTINATION "${INCLUDE_FOLDER}/ptin/${folder}" TYPE FILE FILES "${SOURCE}/${header}")
endforeach()
