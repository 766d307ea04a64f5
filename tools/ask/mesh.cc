// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/ask/questions.h"

namespace ptin::ask {

Fields<tools::LocalFrame> frame_fields() {
  Fields<tools::LocalFrame> fields;
  fields.add("origin", "array of numbers", kMapUnit, "x, y, and 0 for the height.",
             &tools::LocalFrame::origin);
  fields.add("scale", "array of numbers", "", "Metres in a unit of x, y and height.",
             &tools::LocalFrame::scale);
  return fields;
}

Fields<MeshAnswer> mesh_fields() {
  using Row = MeshAnswer;
  const auto of_tin = [](std::uint64_t RefinedTin::*count) {
    return [count](const Row& a) { return a.refined->*count; };
  };
  Fields<Row> written;
  written.add("vertices", "integer", "", "In the output.", &Row::vertices);
  written.add("triangles", "integer", "", "In the output: no void ones.", &Row::triangles);
  Fields<Row> fields;
  fields.add("vertices", "integer", "",
             "All of the mesh, T0 and void ones included; with `refine --clip` the part of it that "
             "meets the region.",
             of_tin(&RefinedTin::vertices));
  fields.add("void_vertices", "integer", "", "Those without a height.",
             of_tin(&RefinedTin::void_vertices));
  fields.add("triangles", "integer", "", "All of the same mesh, void ones included.",
             of_tin(&RefinedTin::triangles));
  fields.add("t0_vertices", "integer", "", "Vertices of T0.", of_tin(&RefinedTin::t0_vertices));
  fields.add_object("written", "object", "What is in the output, or would be.", written,
                    [](const Row& a) { return &a; });
  fields.add_object("local_frame", "object",
                    "Where coordinates of STL stand: local = (map - origin) * scale.",
                    frame_fields(), &Row::frame);
  return fields;
}

Fields<StreamSummary> stream_fields() {
  using Row = StreamSummary;
  Fields<Row> fields;
  fields.add("base_vertices", "integer", "",
             "Vertices of T0, or of the mesh that the receiver has.", &Row::base_vertices);
  fields.add("splits", "integer", "", "Sent.", &Row::splits);
  fields.add("frames", "integer", "", "Sent.", &Row::frames);
  fields.add("bytes", "integer", "bytes", "Sent.", &Row::bytes);
  fields.add("split_bytes", "integer", "bytes", "Bytes of frames of splits.", &Row::split_bytes);
  return fields;
}

}  // namespace ptin::ask
