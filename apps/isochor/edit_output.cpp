#include "edit_output.h"

#include "busy_line.h"
#include "isochor/base/error.h"
#include "isochor/io/file.h"
#include "isochor/io/model_json.h"
#include "terminal.h"

namespace isochor::app {
namespace {

#ifdef ISOCHOR_WITH_OCCT

Value facts_value(const ShapeFacts& facts) {
  return Value::object()
      .set("valid", facts.valid)
      .set("defects", facts.defects)
      .set("closed", facts.closed)
      .set("solids", facts.solids)
      .set("max_tolerance", facts.max_tolerance)
      .set("max_edge_gap", facts.max_edge_gap)
      .set("max_vertex_gap", facts.max_vertex_gap)
      .set("area", facts.area)
      .set("volume", facts.volume)
      .set("volume_bound", facts.volume_bound)
      .set("undefined_by_gaps", facts.undefined_by_gaps());
}

WrittenModel write_solid(const LoadedModel& before, const EditSession& session,
                         const std::string& output, double trim_tolerance, const Common& common) {
  const auto faces = edited_faces(*before.solid, session.model(), session.moved_patches());
  BusyLine busy(common, "writing and checking " + output);
  ReadOptions options = read_options(common, busy);
  options.convert = before.converted;
  const WriteReport report = write_edited(before.path, options, faces, output, trim_tolerance);
  WrittenModel result;
  result.written = report.written;
  result.refusal = report.refusal;
  const double growth = report.reread.max_tolerance > report.before.max_tolerance
                            ? report.reread.max_tolerance - report.before.max_tolerance
                            : 0.0;
  result.report.emplace_back("check",
                             Value::object()
                                 .set("before", facts_value(report.before))
                                 .set("rebuilt", facts_value(report.rebuilt))
                                 .set("reread", facts_value(report.reread))
                                 .set("tolerance_growth", growth)
                                 .set("untouched_bspline_faces", report.faces_bspline_untouched)
                                 .set("untouched_bspline_faces_identical", report.faces_identical)
                                 .set("analytic_faces_ulps", report.analytic_ulps)
                                 .set("edited_faces", static_cast<long>(faces.size()))
                                 .set("edited_faces_exact", report.edited_exact)
                                 .set("written_by", report.written_by)
                                 .set("lines_appended", report.lines_appended)
                                 .set("lines_repointed", report.lines_repointed)
                                 .set("not_line_by_line", report.not_line_by_line)
                                 .set("notices", report.notices));
  result.lines.push_back(
      format("check: %s, largest edge gap %.3g (before %.3g), largest tolerance %.3g (before %.3g)",
             report.reread.valid ? "valid" : "not valid", report.reread.max_edge_gap,
             report.before.max_edge_gap, report.reread.max_tolerance, report.before.max_tolerance));
  result.lines.push_back(format("untouched B-spline faces bit-identical after re-reading: %d of %d",
                                report.faces_identical, report.faces_bspline_untouched));
  if (report.not_line_by_line.empty() && report.lines_appended + report.lines_repointed > 0) {
    result.lines.push_back(
        format("written line by line: %d lines appended, references changed in %d, all others kept",
               report.lines_appended, report.lines_repointed));
  } else if (!report.not_line_by_line.empty()) {
    result.lines.push_back("written anew by OpenCASCADE, not line by line: " +
                           report.not_line_by_line);
  }
  return result;
}

#endif

}  // namespace

WrittenModel write_edited_model(const LoadedModel& before, const EditSession& session,
                                const std::string& output, double trim_tolerance,
                                const Common& common) {
  WrittenModel result;
  const bool json = extension_of(output) == "isochor.json";
#ifdef ISOCHOR_WITH_OCCT
  if (before.solid && is_cad_file(output)) {
    return write_solid(before, session, output, trim_tolerance, common);
  }
#else
  (void)common;
  (void)trim_tolerance;
#endif
  if (json) {
    write_file(output, format_model(session.model()));
    result.written = true;
    return result;
  }
  throw InputError(output, "",
                   "cannot write this format here; a STEP, IGES or BREP model is written to one "
                   "of these formats, an .isochor.json model to .isochor.json (use convert then)");
}

}  // namespace isochor::app
