# SPDX-License-Identifier: GPL-3.0-or-later
#
# The public headers: what users of the library need. Run at installation, this file copies them from SOURCE into
# INCLUDE_FOLDER/ptin, those of MPI where it is there (WITH_MPI). All other headers are how a room works inside. `tests/layering`
# reads the lists: a public header includes public headers alone, the test of the installation includes nothing else, and tools
# include public headers and those that the program needs besides.
cmake_policy(VERSION 3.25)
set(public_headers
    engine/construct/build.h
    engine/construct/build_observer.h
    engine/construct/build_options.h
    engine/construct/build_plan.h
    engine/construct/build_parts.h
    engine/construct/grid/left_out.h
    engine/construct/grid/source_disk.h
    engine/construct/grid/source_options.h
    engine/construct/grid/source_warning.h
    engine/construct/tasks/stage_progress.h
    engine/construct/hierarchy/tile_bytes.h
    engine/construct/memory_plan.h
    engine/construct/read/input_kind.h
    engine/construct/scratch/manifest.h
    engine/construct/scratch/workspace.h
    engine/construct/collapse/cost.h
    engine/construct/tile/tile_tree.h
    engine/crs/border_move.h
    engine/crs/crs_facts.h
    engine/crs/ground.h
    engine/crs/ground_facts.h
    engine/crs/height_unit.h
    engine/error.h
    engine/geometry/affine.h
    engine/geometry/box.h
    engine/geometry/convex_hull.h
    engine/geometry/height.h
    engine/geometry/infinity.h
    engine/geometry/interval.h
    engine/geometry/orient.h
    engine/geometry/point.h
    engine/growing_array.h
    engine/large_array.h
    engine/memory_units.h
    engine/mesh/link.h
    engine/mesh/star.h
    engine/mesh/tin.h
    engine/mesh/vertex_table.h
    engine/prefetch.h
    engine/query/heights/class_changes.h
    engine/query/heights/highest.h
    engine/query/heights/locate.h
    engine/query/heights/profile.h
    engine/query/isoline/isoline.h
    engine/query/isoline/isoline_bands.h
    engine/query/isoline/isoline_clip.h
    engine/query/isoline/isoline_cut.h
    engine/query/isoline/isoline_pieces.h
    engine/query/isoline/isoline_progressive.h
    engine/query/isoline/levels.h
    engine/query/isoline/point_store.h
    engine/query/living/grid_cell.h
    engine/query/living/living_triangle.h
    engine/query/living/tin_parts.h
    engine/query/questions.h
    engine/query/received/received_mesh.h
    engine/query/refine/hierarchy_check.h
    engine/query/refine/moving_window.h
    engine/query/refine/page_cache.h
    engine/query/refine/refine.h
    engine/query/refine/refinement.h
    engine/query/select/accounting.h
    engine/query/select/answer_by.h
    engine/query/select/certificate.h
    engine/query/select/detail.h
    engine/query/select/opened_terrain.h
    engine/query/select/polygon_sides.h
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
    engine/query/volume/plane_area.h
    engine/query/volume/volume.h
    engine/query/walk/point_state.h
    engine/remote/remote_file.h
    engine/stop.h
    storage/attributes.h
    storage/coarsest_tin.h
    storage/file/announcer.h
    storage/file/file_layer.h
    storage/file/io_counters.h
    storage/file/range_source.h
    storage/file/replaced_file.h
    storage/file/sigbus_guard.h
    storage/index.h
    storage/layout.h
    storage/living_stars.h
    storage/page_store.h
    storage/record.h
    storage/star.h
    storage/store_facts.h
    storage/store_file.h
    storage/verify.h)
# What the program needs and users of the library do not: readers of texts and sorting in files, by which it reads points and
# measures samples again, and what it shows of files and processes. They are not installed.
set(program_headers
    engine/check.h
    engine/construct/grid/decimal.h
    engine/construct/grid/source_point.h
    engine/construct/points/open_points.h
    engine/construct/process_limits.h
    engine/construct/raster/vrt_background.h
    engine/construct/read/column_names.h
    engine/construct/read/declared_comments.h
    engine/construct/read/layer_choice.h
    engine/construct/read/line_file.h
    engine/construct/read/point_stream.h
    engine/construct/read/text_rows.h
    engine/construct/read/text_table.h
    engine/construct/scratch/external_memory.h
    engine/construct/scratch/external_sorter.h
    engine/crs/proj_messages.h
    engine/geometry/hilbert.h
    storage/file/file_questions.h
    storage/file_beginning.h
    storage/index_shape.h
    storage/spatialindex_rtree.h)
if(WITH_MPI)
  list(APPEND public_headers
    engine/mpi/mpi_job.h)
endif()

cmake_path(ABSOLUTE_PATH INCLUDE_FOLDER BASE_DIRECTORY "${CMAKE_INSTALL_PREFIX}")
foreach(header IN LISTS public_headers)
  get_filename_component(folder ${header} DIRECTORY)
  file(INSTALL DESTINATION "${INCLUDE_FOLDER}/ptin/${folder}" TYPE FILE FILES "${SOURCE}/${header}")
endforeach()
