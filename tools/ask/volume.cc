// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/ask/questions.h"

namespace ptin::ask {

namespace {

void add_volume_of(Fields<VolumeResult>& fields, const std::string& name, std::string_view meaning,
                   CertifiedVolume VolumeResult::*volume) {
  Fields<CertifiedVolume> parts;
  parts.add("volume", "number", "", "Volume of the TIN that was asked.", Told::kObject,
            &CertifiedVolume::value);
  parts.add("low", "number", "", "The source's is no less.", &CertifiedVolume::low);
  parts.add("high", "number", "", "The source's is no more.", &CertifiedVolume::high);
  fields.add(name, "number", "", meaning, Told::kTableRow,
             [volume](const VolumeResult& r) { return (r.*volume).value; });
  fields.add_object(name, "object", meaning, parts, volume);
}

void add_area(Fields<VolumeResult>& fields, const std::string& name, std::string_view meaning,
              double VolumeResult::*area) {
  fields.add("area." + name, "number", "", meaning, Told::kObject, area);
  fields.add(name + "_area", "number", "", meaning, Told::kTableRow, area);
}

Fields<VolumeResult> result_fields() {
  Fields<VolumeResult> fields;
  add_volume_of(fields, "cut", "What lies above the level, or above the other terrain.",
                &VolumeResult::cut);
  add_volume_of(fields, "fill", "What is missing below.", &VolumeResult::fill);
  add_volume_of(fields, "net", "Cut less fill.", &VolumeResult::net);
  fields.add("rounding", "number", "",
             "How far rounding can have changed cut, fill or net; it is in the bounds.",
             Told::kObject, &VolumeResult::rounding);
  fields.add("mean_difference", "number or null", kHeightUnit, "Net volume by surface area.",
             Told::kObject, &VolumeResult::mean_difference);
  fields.add("area", "object", "", "Areas of the plane.", Told::kObject,
             [](const VolumeResult&) { return Json(Json::object()); });
  add_area(fields, "surface",
           "Where the difference is known: FILE is surface, and so is the other.",
           &VolumeResult::surface_area);
  add_area(fields, "cut", "Where it is above 0.", &VolumeResult::cut_area);
  add_area(fields, "fill", "Where it is below 0.", &VolumeResult::fill_area);
  add_area(fields, "void",
           "Within the hull of FILE (and of the other), and void there (in either).",
           &VolumeResult::void_area);
  fields.add("area.only_file", "number", "",
             "Where FILE is surface and the other is void or has ended; 0 without another.",
             Told::kObject, &VolumeResult::only_here_area);
  fields.add("area.only_against", "number", "", "The other way round.", Told::kObject,
             &VolumeResult::only_other_area);
  return fields;
}

}  // namespace

void add_question(Parameters& rows, VolumeQuestion& question) {
  add_levels(rows, question.levels, "Heights; of several the answer is a table",
             "Every multiple of D, from the base", Door::kProgram);
  rows.add("against", &question.against, "OTHER",
           "A second .ptin file, on any grid, in the same CRS; cut is where FILE is above it")
      .excluding("level interval");
  add_region(rows, question.region, Door::kProgram);
  add_detail(rows, question.detail, ", of either file; volumes come with intervals",
             "Measure the TINs of the N most important vertices; volumes come with intervals");
}

Fields<VolumeRow> volume_row_fields() {
  Fields<VolumeRow> fields;
  fields.add(
      "level", "number or null", kHeightUnit,
      "As asked; null against another terrain. Where there are several, this and the next ones, "
      "down to `area`, stand in `levels`.",
      [](const VolumeRow& r) { return r.level ? Json(*r.level) : Json(); });
  fields.add_parts("", result_fields(), &VolumeRow::result);
  return fields;
}

Fields<VolumeAnswer> volume_fields() {
  using Row = VolumeAnswer;
  Fields<Row> fields;
  fields.add_parts("", volume_row_fields().told(Told::kDocument),
                   [](const Row& a) { return a.rows.size() == 1 ? &a.rows[0] : nullptr; });
  fields.add_array("levels", "One for each of several levels, in the order of the question.",
                   volume_row_fields().told(Told::kDocument),
                   [](const Row& a) { return a.rows.size() == 1 ? nullptr : &a.rows; });
  fields.add_object("against", "object or null", "The other terrain, in its units.",
                    certificate_fields(), &Row::other_facts);
  fields.add("against.file", "string", "", "As asked.",
             [](const Row& a) { return a.other_facts ? Json(a.against) : kLeftOut; });
  fields.add("units.ground", "string", "",
             "The unit whose squares and cubes areas and volumes are.", &Row::ground_unit);
  return fields;
}

}  // namespace ptin::ask
