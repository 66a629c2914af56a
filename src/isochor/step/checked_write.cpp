#include "isochor/step/checked_write.h"

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

namespace isochor::internal {
namespace {

// The share of the first attempt in the progress shown; the second is rarely needed.
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

// Child 1: everything up to the temporary file.
WriteReport change_and_write(const WriteJob& job, const std::string& path, WriteSettings settings) {
  WriteReport report;
  Document document = source_of(job, 0.3);
  if (format_of(path) == FileFormat::kStep) settings.surfaces = changed_by_reader(document);
  for (const auto& edit : job.edits) settings.surfaces.erase(edit.face);
  report.notices = document.notices;
  tell_progress(0.3, "checking what is there");
  report.before = shape_facts(document);
  const TopoDS_Shape old = document.shape;
  if (format_of(path) != FileFormat::kBrep && document.unit.occt.empty()) {
    report.refusal = "the length unit of " + document.unit.name +
                     " cannot be written without rounding; BREP keeps the numbers";
    return report;
  }
  if (job.must_be_valid && !report.before.valid) {
    report.refusal = objection_to_rebuilt(report.before, report.before);
    return report;
  }
  if (!job.edits.empty()) {
    tell_progress(0.5, "changing faces");
    report.refusal = rebuild(document, job.edits, job.convert);
    if (!report.refusal.empty()) return report;
    tell_progress(0.6, "checking the result");
    report.rebuilt = shape_facts(document);
    report.refusal = objection_to_rebuilt(report.before, report.rebuilt);
    if (report.refusal.empty()) report.refusal = objection_to_gaps(old, document.shape);
    if (!report.refusal.empty()) return report;
  } else {
    report.rebuilt = report.before;
  }
  note_losses(document, format_of(path), report.notices);
  tell_progress(0.8, "writing");
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
  const std::string growth = tolerance_growth(report.rebuilt, report.reread);
  if (!growth.empty() && job.edits.empty()) report.notices.push_back(growth);
  if (report.refusal.empty() && !job.edits.empty()) report.refusal = growth;
  const GapGrowth gaps = gap_growth(report.rebuilt, report.reread);
  for (const std::string& text : {gaps.inside, gaps.beyond}) {
    if (!text.empty()) report.notices.push_back(text);
  }
  if (report.refusal.empty() && !job.edits.empty()) report.refusal = gaps.beyond;
  return report;
}

WriteReport attempt(const WriteJob& job, const std::string& path, const WriteSettings& settings,
                    const Watch& watch) {
  const std::function<WriteReport()> first = [&] { return change_and_write(job, path, settings); };
  WriteReport report;
  try {
    report = call_in_child(job.input, first, job.limits, watch.part(0.0, 0.6));
  } catch (const InputError& e) {
    // Errors about the temporary file are errors about the output.
    if (e.file() == path) throw InputError(job.output, e.entity(), e.reason());
    throw;
  }
  if (!report.refusal.empty()) return report;
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

}  // namespace

WriteReport write_checked(const WriteJob& job) {
  const FileFormat format = format_of(job.output);
  OutputFile file(job.output);
  WriteReport report = attempt(job, file.temporary(), {}, job.watch.part(0.0, kFirstAttempt));
  // Refusals before writing leave no facts of the file; others may be due to the parameter curves.
  const bool was_written = report.refusal.empty() || report.reread.diagonal > 0.0;
  if (!report.refusal.empty() && was_written && format == FileFormat::kStep) {
    WriteSettings plain;
    plain.parameter_curves = false;
    WriteReport second = attempt(job, file.temporary(), plain, job.watch.part(kFirstAttempt, 1.0));
    if (second.refusal.empty()) {
      second.notices.push_back("written without parameter curves: with them, " + report.refusal);
      report = std::move(second);
    }
  }
  if (report.refusal.empty()) {
    file.commit();
    report.written = true;
  }
  return report;
}

}  // namespace isochor::internal
