// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/ask/answer_facts.h"

namespace ptin::ask {

namespace {

const Fields<AnswerFacts> kCertainty = {
    {{"certified_error", "number or null", "height's unit",
      "How far the answer is off at an input sample, at most."},
     [](const AnswerFacts& a) -> Json { return a.certified_error; }},
    {{"certified_deviation", "number or null", "height's unit",
      "How far the answer is off at any point, at most."},
     [](const AnswerFacts& a) -> Json { return a.certified_deviation; }},
    {{"border_moved_at_most", "number or null",
      "ground units (metres where the CRS is in degrees, else units of the plane)",
      "How far the border between surface and void may be from that of the source, either way: "
      "`certified_error` over `--void-slope`. 0 for a terrain without voids; null where nothing "
      "bounds it (a slope of 0)."},
     [](const AnswerFacts& a) -> Json { return a.border_moved_at_most; }},
    {{"exact", "boolean", "", "Nothing was left out, and the file's finest TIN is its source."},
     [](const AnswerFacts& a) -> Json { return a.exact; }},
    {{"unit", "string", "", "The height's unit; `unknown` where nobody knows.", Door::kService},
     [](const AnswerFacts& a) -> Json { return a.crs->vertical_unit; }}};

const Fields<tools::Transformed> kTransformed = {
    {{"from", "string", "", "The name of their CRS."},
     [](const tools::Transformed& t) -> Json { return t.from; }},
    {{"bent_at_most", "number", "map unit",
      "How far a side, straight in that CRS, is from the one that was asked with."},
     [](const tools::Transformed& t) -> Json { return t.bent_at_most; }}};

const Fields<CrsFacts> kUnits = {{{"horizontal", "string", "", "The map unit."},
                                  [](const CrsFacts& crs) -> Json { return crs.horizontal_unit; }},
                                 {{"height", "string", "", "The height's unit."},
                                  [](const CrsFacts& crs) -> Json { return crs.vertical_unit; }}};

const Fields<QueryCost> kCost = {
    {{"records_retrieved", "integer", "", "Records that the question asks for."},
     [](const QueryCost& c) -> Json { return c.records_retrieved; }},
    {{"records_examined", "integer", "", "Records of the pages that were read."},
     [](const QueryCost& c) -> Json { return c.records_examined; }},
    {{"records_applied", "integer", "", "Splits made."},
     [](const QueryCost& c) -> Json { return c.records_applied; }},
    {{"stars_read", "integer", "", "Stars decoded, each with all its triangles."},
     [](const QueryCost& c) -> Json { return c.stars_read; }},
    {{"index_nodes", "integer", "", "Nodes of the index whose entries were examined."},
     [](const QueryCost& c) -> Json { return c.io.index_nodes; }},
    {{"pages", "integer", "", "Record pages read."},
     [](const QueryCost& c) -> Json { return c.io.pages; }},
    {{"bytes_read", "integer", "bytes", "Of these pages and nodes."},
     [](const QueryCost& c) -> Json { return c.io.bytes_read; }},
    {{"remote_rounds", "integer", "",
      "How often the question waited for the server of a [file elsewhere](#files-elsewhere), after "
      "its opening; 0 of other files, as the next two."},
     [](const QueryCost& c) -> Json { return c.io.remote_rounds; }},
    {{"remote_requests", "integer", "", "Ranges that it asked for."},
     [](const QueryCost& c) -> Json { return c.io.remote_requests; }},
    {{"remote_bytes", "integer", "bytes", "That these held."},
     [](const QueryCost& c) -> Json { return c.io.remote_bytes; }},
    {{"seconds", "number", "seconds", "On the clock."},
     [](const QueryCost& c) -> Json { return c.seconds; }}};

}  // namespace

Json cost_json(const QueryCost& cost) { return object_of(kCost, cost, Door::kProgram); }

Json units_json(const CrsFacts& crs) { return object_of(kUnits, crs, Door::kProgram); }

void put(Json& answer, const AnswerFacts& facts, Door door) {
  put(answer, kCertainty, facts, door);
  if (door == Door::kService) return;  // Where units are told once, and costs in a header.
  if (facts.transformed != nullptr) {
    answer["transformed"] =
        *facts.transformed ? object_of(kTransformed, **facts.transformed, door) : Json();
  }
  answer["units"] = units_json(*facts.crs);
  if (facts.cost != nullptr) answer["cost"] = cost_json(*facts.cost);
}

std::vector<NamedField> answer_fields() {
  std::vector<NamedField> all;
  const auto object = [&](const char* name, const char* type, const char* meaning) {
    all.push_back({name, {name, type, "", meaning, Door::kProgram}});
  };
  list(all, kCertainty);
  object("transformed", "object or null",
         "What was done to lines or a polygon of another CRS; null where nothing was.");
  list(all, kTransformed, "transformed.");
  object("units", "object", "The names of the units; `unknown` where nobody knows.");
  list(all, kUnits, "units.");
  object("cost", "object", "What the question took.");
  list(all, kCost, "cost.");
  return all;
}

}  // namespace ptin::ask
