#include "isochor/step/checked_write.h"

#include <cmath>
#include <cstdio>
#include <fstream>

#include "isochor/base/error.h"
#include "isochor/step/bridge.h"
#include "isochor/step/checks.h"
#include "isochor/step/child_progress.h"
#include "isochor/step/compare_faces.h"
#include "isochor/step/exchange.h"
#include "isochor/step/model_bytes.h"
#include "isochor/step/output_file.h"
#include "isochor/step/rebuild.h"
#include "isochor/step/shape_facts.h"
#include "isochor/step/solid_moments.h"
#include "isochor/step/surgical.h"
#include "isochor/step/surgical_plan.h"

namespace isochor::internal {
namespace {

constexpr const char* kLineByLine = "line by line";
constexpr const char* kOpenCascade = "OpenCASCADE";

// The share of a first attempt in the progress shown; others are rarely needed.
constexpr double kFirstAttempt = 0.8;

// What the output cannot carry, in words.
void note_losses(const Document& document, FileFormat output, std::vector<std::string>& notices) {
  const bool labels = !document.names.empty();
  if (output == FileFormat::kBrep) {
    if (labels) notices.push_back("BREP keeps no names, colours or structure");
    if (document.unit.stated) {
      notices.push_back("BREP keeps no length unit: the numbers are in " + document.unit.name);
    }
  }
  if (output == FileFormat::kIges && labels) {
    notices.push_back("IGES keeps names, colours and structure only in part");
  }
  if (output != FileFormat::kBrep && !document.unit.stated) {
    notices.push_back("the input states no length unit; written as " + document.unit.name);
  }
}

Document source_of(const WriteJob& job, double share) {
  const ProgressPart part(0.0, share);
  return job.source();
}

// One way to the output.
struct Way {
  bool line_by_line = false;
  WriteSettings settings;  // of OpenCASCADE's writer
};

// OpenCASCADE writes what it has read: what it lost on the way in would be lost for good. Lines
// that are not touched lose nothing. A change of format may mend a file that breaks rules but lost
// no face; an edit would build on what is not known.
std::string objection_to_import(const WriteJob& job, const ImportAccount& account, const Way& way) {
  const bool nothing_lost = account.lost.empty() || way.line_by_line;
  const bool rules_matter = !account.broken.empty() && !job.edits.empty();
  return nothing_lost && !rules_matter ? "" : account.objection();
}

// What is read back is compared within the error bound: one as large as the volume proves nothing.
// Negated, so that a bound that is no number objects too.
std::string objection_to_bound(const ShapeFacts& facts) {
  if (!facts.closed || facts.volume_bound < std::abs(facts.volume)) return "";
  char text[160];
  std::snprintf(text, sizeof text,
                "the volume of the input is not determined (%.3g, error at most %.2g), so what is "
                "written could not be checked",
                facts.volume, facts.volume_bound);
  return text;
}

// The rebuilt shape, checked before anything is written. A refusal is final: no way helps.
std::vector<RebuildPlan> rebuild_and_check(const WriteJob& job, Document& document,
                                           WriteReport& report) {
  std::vector<RebuildPlan> plans;
  report.rebuilt = report.before;
  if (job.must_be_valid && !report.before.valid) {
    report.refusal = objection_to_rebuilt(report.before, report.before);
    return plans;
  }
  if (job.edits.empty()) return plans;
  report.refusal = objection_to_bound(report.before);
  if (!report.refusal.empty()) return plans;
  const TopoDS_Shape old = document.shape;
  tell_progress(0.5, "changing faces");
  report.refusal = rebuild(document, job.edits, job.convert, &plans, job.trim_tolerance);
  if (!report.refusal.empty()) return plans;
  tell_progress(0.6, "checking the result");
  report.rebuilt = shape_facts(document);
  report.refusal = objection_to_rebuilt(report.before, report.rebuilt, job.trim_tolerance);
  if (report.refusal.empty()) report.refusal = objection_to_gaps(old, document.shape);
  return plans;
}

// For the volumes, areas and centroids that files state.
MeasureChange measure_change(const TopoDS_Shape& before, const TopoDS_Shape& after,
                             const WriteReport& report) {
  MeasureChange change;
  change.known = report.before.solids == 1 && report.before.closed && report.before.volume != 0.0;
  if (!change.known) return change;
  change.volume_factor = report.rebuilt.volume / report.before.volume;
  change.area_factor = report.rebuilt.area / report.before.area;
  const Moments a = moments_from(shape_moments(before)), b = moments_from(shape_moments(after));
  change.centroid_shift = b.centroid - a.centroid;
  return change;
}

// The file has an edge of its own for each face, and vertices likewise.
std::string objection_to_sewn_edges(const Document& document,
                                    const std::vector<RebuildPlan>& plans) {
  if (!document.sewn()) return "";
  for (const auto& plan : plans) {
    if (!plan.curves.empty() || !plan.points.empty()) {
      return "edges move, and the faces were sewn on reading, so they are not the edges of the "
             "file";
    }
  }
  return "";
}

// Returns why not, in words. `before`: the shape as it was read.
std::string write_lines(const WriteJob& job, const Document& document, const TopoDS_Shape& before,
                        const std::vector<RebuildPlan>& plans, const std::string& path,
                        WriteReport& report) {
  const std::string objection = objection_to_sewn_edges(document, plans);
  if (!objection.empty()) return objection;
  SurgicalText text;
  try {
    const Part21File file = load_part21(job.step_text);
    SurgicalEdit edit = surgical_edit(document, plans);
    if (!plans.empty() && states_measures(file)) {
      edit.measures = measure_change(before, document.shape, report);
    }
    text = edit_text(file, edit);
  } catch (const InputError& e) {
    return (e.entity().empty() ? "" : e.entity() + ": ") + e.reason();
  }
  if (!text.refusal.empty()) return text.refusal;
  std::ofstream out(path, std::ios::binary);
  if (!out) throw InputError(path, "", "cannot be opened for writing");
  out << text.text;
  out.close();
  if (!out) throw InputError(path, "", "cannot be written (disk full?)");
  report.written_by = kLineByLine;
  report.lines_appended = text.lines_appended;
  report.lines_repointed = text.lines_repointed;
  report.notices.insert(report.notices.end(), text.notices.begin(), text.notices.end());
  return "";
}

bool states_any(const WriteJob& job) {
  if (job.step_text.empty()) return false;
  try {
    return states_measures(load_part21(job.step_text));
  } catch (const InputError&) {
    return false;  // a text that cannot be read line by line
  }
}

// Child 1: everything up to the temporary file.
WriteReport change_and_write(const WriteJob& job, const std::string& path, Way way) {
  WriteReport report;
  Document document = source_of(job, 0.3);
  WriteSettings& settings = way.settings;
  report.refusal = objection_to_import(job, document.account, way);
  if (!report.refusal.empty()) return report;
  if (format_of(path) == FileFormat::kStep) settings.surfaces = changed_by_reader(document);
  for (const auto& edit : job.edits) settings.surfaces.erase(edit.face);
  report.notices = document.notices;
  tell_progress(0.3, "checking what is there");
  report.before = shape_facts(document);
  if (!way.line_by_line && format_of(path) != FileFormat::kBrep && document.unit.occt.empty()) {
    report.refusal = "the length unit of " + document.unit.name +
                     " cannot be written without rounding; BREP keeps the numbers";
    return report;
  }
  const TopoDS_Shape before = document.shape;
  const auto plans = rebuild_and_check(job, document, report);
  if (!report.refusal.empty()) return report;
  tell_progress(0.8, "writing");
  if (way.line_by_line) {
    report.not_line_by_line = write_lines(job, document, before, plans, path, report);
    return report;
  }
  note_losses(document, format_of(path), report.notices);
  settings.stated_measures = job.edits.empty();
  if (!settings.stated_measures && format_of(path) == FileFormat::kStep && states_any(job)) {
    report.notices.push_back("stated volumes, areas and centroids were dropped");
  }
  report.written_by = kOpenCascade;
  write_document(document, path, settings);
  return report;
}

// Child 2: a fresh look at the file. Adds to the report of child 1.
WriteReport read_back(const WriteJob& job, const std::string& path, WriteReport report) {
  const Document before = source_of(job, 0.4);
  const Document after = [&] {
    const ProgressPart part(0.4, 0.7);
    return load_document(path);
  }();
  tell_progress(0.7, "checking what was written");
  report.reread = shape_facts(after);
  const bool labels = !before.xde.IsNull() && format_of(path) == FileFormat::kStep;
  const FaceComparison faces = compare_faces(before, after, job.edits);
  report.faces_bspline_untouched = faces.bspline_untouched;
  report.faces_identical = faces.identical;
  report.edited_exact = faces.edited_exact;
  report.analytic_ulps = faces.analytic_ulps;
  report.notices.insert(report.notices.end(), faces.notices.begin(), faces.notices.end());
  report.refusal = objection_to_reread(report.rebuilt, report.reread, labels);
  if (report.refusal.empty()) report.refusal = faces.objection;
  const std::string growth = tolerance_growth(report.rebuilt, report.reread, job.trim_tolerance);
  if (!growth.empty() && job.edits.empty()) report.notices.push_back(growth);
  if (report.refusal.empty() && !job.edits.empty()) report.refusal = growth;
  const GapGrowth gaps = gap_growth(report.rebuilt, report.reread);
  for (const std::string& text : {gaps.inside, gaps.beyond}) {
    if (!text.empty()) report.notices.push_back(text);
  }
  if (report.refusal.empty() && !job.edits.empty()) report.refusal = gaps.beyond;
  return report;
}

WriteReport attempt(const WriteJob& job, const std::string& path, const Way& way,
                    const Watch& watch) {
  const std::function<WriteReport()> first = [&] { return change_and_write(job, path, way); };
  WriteReport report;
  try {
    report = call_in_child(job.input, first, job.limits, watch.part(0.0, 0.6));
  } catch (const InputError& e) {
    // Errors about the temporary file are errors about the output.
    if (e.file() == path) throw InputError(job.output, e.entity(), e.reason());
    throw;
  }
  if (!report.refusal.empty() || !report.not_line_by_line.empty()) return report;
  const std::function<WriteReport()> second = [&] { return read_back(job, path, report); };
  try {
    return call_in_child(job.output, second, job.limits, watch.part(0.6, 1.0));
  } catch (const LimitError&) {
    throw;
  } catch (const InputError& e) {
    report.refusal = "the written file cannot be read back: " + e.reason();
    return report;
  }
}

// Refusals before writing stand, whatever the way; after it they may be due to the way.
bool was_written(const WriteReport& report) { return !report.written_by.empty(); }

WriteReport by_writer(const WriteJob& job, const std::string& path, const Watch& watch) {
  WriteReport report = attempt(job, path, {}, watch.part(0.0, kFirstAttempt));
  if (report.refusal.empty() || !was_written(report) || format_of(path) != FileFormat::kStep) {
    return report;
  }
  Way plain;
  plain.settings.parameter_curves = false;
  WriteReport second = attempt(job, path, plain, watch.part(kFirstAttempt, 1.0));
  if (!second.refusal.empty()) return report;
  second.notices.push_back("written without parameter curves: with them, " + report.refusal);
  return second;
}

// Empty `not_line_by_line`: done, or refused whatever the way.
WriteReport by_lines(const WriteJob& job, const std::string& path, const Watch& watch) {
  Way way;
  way.line_by_line = true;
  WriteReport report = attempt(job, path, way, watch);
  if (!report.refusal.empty() && was_written(report)) report.not_line_by_line = report.refusal;
  return report;
}

}  // namespace

WriteReport write_checked(const WriteJob& job) {
  OutputFile file(job.output);
  WriteReport report;
  const bool lines = !job.step_text.empty() && format_of(job.output) == FileFormat::kStep;
  if (lines) report = by_lines(job, file.temporary(), job.watch.part(0.0, kFirstAttempt));
  if (!lines || !report.not_line_by_line.empty()) {
    const std::string reason = report.not_line_by_line;
    report = by_writer(job, file.temporary(), job.watch.part(lines ? kFirstAttempt : 0.0, 1.0));
    report.not_line_by_line = reason;
    if (lines) report.notices.push_back("written anew by OpenCASCADE, not line by line: " + reason);
  }
  if (report.refusal.empty()) {
    file.commit();
    report.written = true;
  }
  return report;
}

}  // namespace isochor::internal
