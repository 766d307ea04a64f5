// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/ask/answer_facts.h"

namespace ptin::ask {

namespace {

Fields<tools::Transformed> transformed_fields() {
  Fields<tools::Transformed> fields;
  fields.add("from", "string", "", "The name of their CRS.", &tools::Transformed::from);
  fields.add("bent_at_most", "number", kMapUnit,
             "How far a side, straight in that CRS, is from the one that was asked with.",
             &tools::Transformed::bent_at_most);
  return fields;
}

Fields<CrsFacts> unit_fields() {
  Fields<CrsFacts> fields;
  fields.add("horizontal", "string", "", "The map unit.", &CrsFacts::horizontal_unit);
  fields.add("height", "string", "", "The height's unit.", &CrsFacts::vertical_unit);
  return fields;
}

Fields<IoCounters> io_fields() {
  constexpr std::string_view kCount = "integer";
  Fields<IoCounters> fields;
  fields.add("index_nodes", kCount, "", "Nodes of the index whose entries were examined.",
             &IoCounters::index_nodes);
  fields.add("pages", kCount, "", "Record pages read.", &IoCounters::pages);
  fields.add("bytes_read", kCount, "bytes", "Bytes of these pages and nodes.",
             &IoCounters::bytes_read);
  fields.add("remote_rounds", kCount, "",
             "How often the question waited for the server of a [file "
             "elsewhere](#files-elsewhere), after its opening; 0 of other files, as the next two.",
             &IoCounters::remote_rounds);
  fields.add("remote_requests", kCount, "", "Ranges that it asked for.",
             &IoCounters::remote_requests);
  fields.add("remote_bytes", kCount, "bytes", "That these held.", &IoCounters::remote_bytes);
  return fields;
}

Fields<QueryCost> cost_fields() {
  constexpr std::string_view kCount = "integer";
  Fields<QueryCost> fields;
  fields.add("records_retrieved", kCount, "", "Records that the question asks for.",
             &QueryCost::records_retrieved);
  fields.add("records_examined", kCount, "", "Records of the pages that were read.",
             &QueryCost::records_examined);
  fields.add("records_applied", kCount, "", "Splits made.", &QueryCost::records_applied);
  fields.add("stars_read", kCount, "", "Stars decoded, each with all its triangles.",
             &QueryCost::stars_read);
  fields.add("samples_read", kCount, "", "Samples of a raster's heights decoded.",
             &QueryCost::samples_read);
  fields.add_parts("", io_fields(), &QueryCost::io);
  fields.add("seconds", "number", "seconds", "On the clock.", &QueryCost::seconds);
  return fields;
}

}  // namespace

Json cost_json(const QueryCost& cost) { return cost_fields().object_of(cost); }

Json units_json(const CrsFacts& crs) { return unit_fields().object_of(crs); }

Fields<AnswerFacts> certificate_fields() {
  Fields<AnswerFacts> fields;
  fields.add("certified_error", "number or null", kHeightUnit,
             "How far the answer is off at an input sample, at most.",
             &AnswerFacts::certified_error);
  fields.add("certified_deviation", "number or null", kHeightUnit,
             "How far the answer is off at any point, at most.", &AnswerFacts::certified_deviation);
  fields.add("border_moved_at_most", "number or null",
             "ground units (metres where the CRS is in degrees, else units of the plane)",
             "How far the border between surface and void may be from that of the source, either "
             "way: `certified_error` over `--void-slope`. 0 for a terrain without voids; null "
             "where nothing bounds it (a slope of 0).",
             &AnswerFacts::border_moved_at_most);
  return fields;
}

Fields<AnswerFacts> answer_fields() {
  Fields<AnswerFacts> fields = certificate_fields();
  fields.add("exact", "boolean", "",
             "Nothing was left out, and the file's finest TIN is its source.", &AnswerFacts::exact);
  fields.add("unit", "string", "", "The height's unit; `unknown` where nobody knows.",
             Told::kService, [](const AnswerFacts& a) { return a.crs->vertical_unit; });
  // The service tells units once, and costs in a header.
  fields.next = Told::kProgram;
  fields.add("transformed", "object or null", "",
             "What was done to lines or a polygon of another CRS; null where nothing was.",
             [](const AnswerFacts& a) {
               if (a.transformed == nullptr) return kLeftOut;
               return *a.transformed ? Json(Json::object()) : Json();
             });
  fields.add_parts("transformed.", transformed_fields(), [](const AnswerFacts& a) {
    return a.transformed != nullptr && *a.transformed ? &**a.transformed : nullptr;
  });
  fields.add_object("units", "object", "The names of the units; `unknown` where nobody knows.",
                    unit_fields(), &AnswerFacts::crs);
  fields.add_object("cost", "object", "What the question took.", cost_fields(), &AnswerFacts::cost);
  return fields;
}

}  // namespace ptin::ask
