#include <algorithm>
#include <cstdio>
#include <set>

#include "busy_line.h"
#include "commands.h"
#include "edit_output.h"
#include "isochor/base/error.h"
#include "isochor/io/edits_json.h"
#include "isochor/io/file.h"
#include "isochor/io/report_html.h"
#include "isochor/io/report_json.h"
#include "model_picture.h"
#include "model_source.h"
#include "terminal.h"

namespace isochor::app {
namespace {

// A pole that moves this many times farther than any place was asked to is worth a remark.
constexpr double kFarPole = 5.0;

// All patches that a script names: faces that are not B-spline yet are converted for it.
std::vector<std::string> named_patches(const EditScript& script) {
  std::set<std::string> names;
  const auto add_extent = [&](const Extent& extent) {
    names.insert(extent.patch);
    names.insert(extent.faces.begin(), extent.faces.end());
    for (const auto& item : extent.poles) names.insert(item.first);
  };
  for (const Edit& edit : script.edits) {
    for (const Move& move : edit.moves) names.insert(move.place.patch);
    for (const Hold& hold : edit.holds) {
      if (hold.kind == Hold::Kind::kPlace || hold.kind == Hold::Kind::kNormal) {
        names.insert(hold.place.patch);
      }
    }
    names.insert(edit.follow.faces.begin(), edit.follow.faces.end());
    add_extent(edit.extent);
    if (edit.sink.kind == Sink::Kind::kOtherExtent) add_extent(edit.sink.extent);
    for (const auto& item : edit.scale.knots) names.insert(item.first);
  }
  names.erase("");
  return {names.begin(), names.end()};
}

// How far faces may part at trimming curves that the script moves; 0: it moves none.
double largest_follow_tolerance(const EditScript& script) {
  double largest = 0.0;
  for (const Edit& edit : script.edits) largest = std::max(largest, edit.follow.tolerance);
  return largest;
}

EditScript read_script(const std::string& path) {
  EditScript script = parse_edits(read_file(path), path);
  if (script.edits.empty()) throw InputError(path, "edits", "the list is empty: nothing to do");
  return script;
}

std::vector<Certificate> apply_all(const EditScript& script, EditSession& session,
                                   const std::string& edits_path, const Common& common) {
  std::vector<Certificate> certificates;
  for (size_t k = 0; k < script.edits.size(); ++k) {
    const BusyLine busy(common, "edit \"" + script.edits[k].name + "\"");
    try {
      certificates.push_back(session.apply(script.edits[k], common.cancel));
    } catch (const InputError& error) {
      const std::string where = "edits[" + std::to_string(k) + "]";
      throw InputError(edits_path, error.entity().empty() ? where : where + ": " + error.entity(),
                       error.reason());
    }
    if (common.cancel.cancelled()) throw CancelledError();
    if (certificates.back().outcome != Outcome::kDone) break;
  }
  return certificates;
}

void print_certificate(const Certificate& c, const std::string& unit, const Common& common) {
  print(common, format("edit \"%s\": %s", c.name.c_str(), std::string(name_of(c.outcome)).c_str()));
  if (c.outcome != Outcome::kDone) return;  // the reason goes to stderr
  print(common, format("  volume before    %.15g %s^3", c.volume.before, unit.c_str()));
  print(common, format("  volume after     %.15g %s^3", c.volume.after, unit.c_str()));
  print(common,
        format("  relative change  %.3g (bound %.2g)", c.volume.relative_change, c.volume.bound));
  for (const MoveRecord& move : c.moves) {
    print(common,
          format("  moved            %s by (%.6g, %.6g, %.6g), error %.2g %s", move.place.c_str(),
                 move.got.x(), move.got.y(), move.got.z(), move.error, unit.c_str()));
  }
  for (const FollowRecord& follower : c.followers) {
    print(common, format("  followed         %s within %.2g %s, refined from %d to %d poles",
                         follower.patch.c_str(), follower.deviation, unit.c_str(),
                         follower.poles_before, follower.poles_after));
  }
  if (c.joins.count > 0) {
    print(common, format("  largest gap      %.3g %s at %d joins", c.joins.max_gap, unit.c_str(),
                         c.joins.count));
  }
  print(common, format("  freedom used     %d coefficients in the extent, %d equations, %d left",
                       c.coefficients, c.rank, c.freedom_left));
  if (c.skin.relations > 0) {
    print(common,
          format("  kept smooth      %d joins, knot lines or poles; angles changed by at most "
                 "%.2g rad",
                 c.skin.relations, c.skin.change.angle_rad));
  }
  if (!c.redundant.empty()) {
    std::string names;
    for (const std::string& name : c.redundant) names += (names.empty() ? "" : ", ") + name;
    print(common, "  redundant        " + names + " (follows from the others: ignored)");
  }
  print(common, format("  moved poles      %d, at most by %.4g %s", c.poles_moved, c.max_distance,
                       unit.c_str()));
  double asked = 0.0;
  for (const MoveRecord& move : c.moves) asked = std::max(asked, move.asked.norm());
  if (asked > 0.0 && c.max_distance > kFarPole * asked) {
    note(common,
         format("edit \"%s\": a pole moved %.2g times as far as asked, because the free poles "
                "hardly act on the place: refine, or enlarge the extent",
                c.name.c_str(), c.max_distance / asked));
  }
  for (const LockRecord& lock : c.locked) {
    detail(common, format("locked in the extent: %d coefficients of %s: %s", lock.coefficients,
                          lock.patch.c_str(), lock.reason.c_str()));
  }
}

void require_outputs(const EditOptions& options) {
  require_writable(options.output);
  if (!options.report.empty()) require_writable(options.report);
  if (!options.picture.empty()) require_picture(options.picture);
  if (!options.html.empty()) require_writable(options.html);
}

// The closing planes of the command line, or else of the edits file.
std::vector<ClosingPlane> planes_for(const EditOptions& options, const EditScript& script) {
  std::vector<ClosingPlane> planes;
  try {
    planes = closing_planes(script);
  } catch (const InputError& error) {
    throw error.in_file(options.edits);
  }
  if (options.close.empty()) return planes;
  if (!planes.empty()) {
    throw InputError(options.edits, "close", "the command line names closing planes too: give one");
  }
  return parse_close(options.close);
}

// What the command leaves besides the model.
struct Account {
  Outcome outcome = Outcome::kDone;
  std::string refusal;  // of the written file
  Value::Object extra;  // further keys of the report
  std::vector<std::string> lines;
  std::string png;
};

void write_account(const EditOptions& options, const LoadedModel& loaded,
                   const std::vector<Certificate>& certificates, const Account& account,
                   const Common& common) {
  const std::string report = format_report(certificates, account.outcome, account.extra);
  if (!options.report.empty()) write_file(options.report, report);
  if (!options.picture.empty() && !account.png.empty()) write_file(options.picture, account.png);
  if (!options.html.empty()) {
    write_file(options.html,
               format_html({options.model, loaded.patches.unit, account.outcome, account.refusal,
                            certificates, account.lines, account.png, report}));
  }
  if (common.json) std::fputs(report.c_str(), stdout);
}

}  // namespace

int run_edit(const EditOptions& options, const Common& common) {
  require_outputs(options);
  const EditScript script = read_script(options.edits);
  const std::vector<std::string> named = named_patches(script);
  ShapeMeasures measures;
  measures.close = planes_for(options, script);
  const double trim_tolerance = largest_follow_tolerance(script);
  measures.shared_trims = trim_tolerance > 0.0;
  const LoadedModel loaded =
      load_model(options.model, common,
                 is_cad_file(options.model) ? named : std::vector<std::string>(), measures);
  if (loaded.patches.patches.empty()) {
    throw InputError(options.model, "",
                     "no face can be edited as it is; name a face that can be converted "
                     "(see isochor info)");
  }
  EditSession session(loaded.patches, loaded.surroundings);
  const std::vector<Certificate> certificates = apply_all(script, session, options.edits, common);

  Account account;
  account.outcome = overall_outcome(certificates);
  account.extra = {{"model", Value(options.model)},
                   {"edits_file", Value(options.edits)},
                   {"undefined_by_gaps", Value(loaded.undefined_by_gaps)},
                   {"closed_by", Value(closing_names(loaded))}};
  if (account.outcome == Outcome::kDone) {
    if (!options.picture.empty() || !options.html.empty()) {
      account.png = encode_png(draw_edit(loaded, session, certificates, common));
    }
    WrittenModel written =
        write_edited_model(loaded, session, options.output, trim_tolerance, common);
    account.extra.insert(account.extra.end(), written.report.begin(), written.report.end());
    account.lines = std::move(written.lines);
    if (!closing_text(loaded).empty()) account.lines.push_back("volumes: " + closing_text(loaded));
    if (!gaps_text(loaded).empty())
      account.lines.push_back(gaps_text(loaded) + ", not of its change");
    if (written.written) {
      account.extra.emplace_back("output", options.output);
      if (!options.picture.empty()) account.extra.emplace_back("picture", options.picture);
    } else {
      account.outcome = Outcome::kRefused;
      account.refusal = written.refusal;
      account.extra.emplace_back("refusal", written.refusal);
      account.png.clear();
    }
  }
  write_account(options, loaded, certificates, account, common);

  for (const Certificate& certificate : certificates) {
    print_certificate(certificate, loaded.patches.unit, common);
  }
  for (const std::string& line : account.lines) print(common, line);
  const bool done = account.outcome == Outcome::kDone;
  if (!done) {
    refuse(options.model + ": " + std::string(name_of(account.outcome)) + ": " +
           (account.refusal.empty() ? certificates.back().reason : account.refusal));
  } else {
    print(common, "model:   " + options.output);
  }
  if (!options.report.empty()) print(common, "report:  " + options.report);
  if (done && !options.picture.empty()) print(common, "picture: " + options.picture);
  if (!options.html.empty()) print(common, "page:    " + options.html);
  return done ? kExitDone : kExitNo;
}

}  // namespace isochor::app
