#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>
#include <functional>

#include "commands.h"
#include "interrupt.h"
#include "isochor/base/error.h"

namespace isochor::app {
namespace {

void add_common(CLI::App& app, Common& common) {
  app.add_flag("--json", common.json, "print one JSON value on stdout, nothing else there");
  app.add_flag("-q,--quiet", common.quiet, "print nothing but errors");
  app.add_flag("-v,--verbose", common.verbose, "also print notices of the readers");
  app.add_option("-j,--threads", common.threads,
                 "at most N threads for volumes and gradients (results do not depend on it)")
      ->check(CLI::PositiveNumber);
  app.add_option("--progress", common.progress, "a bar on stderr for long work: auto or never")
      ->check(CLI::IsMember({"auto", "never"}));
  app.add_option("--time-limit", common.bridge_seconds,
                 "seconds of processor time (and five times as much by the clock) for "
                 "reading, converting or writing a CAD file")
      ->check(CLI::PositiveNumber);
  app.add_option("--memory-limit", common.bridge_megabytes,
                 "megabytes for reading, converting or writing a CAD file")
      ->check(CLI::PositiveNumber);
}

void add_close(CLI::App& app, std::vector<std::string>& close) {
  app.add_option("--close", close,
                 "a plane that closes an open model: y=0, z=12.5 or NX,NY,NZ,H; may be repeated")
      ->option_text("PLANE")
      ->expected(1)
      ->take_all();
}

// Commands of CONTRACT that this version does not have: refused by name, not as a typo.
void add_missing(CLI::App& app, std::function<int()>& action) {
  for (const char* name : {"deform", "sculpt", "studio"}) {
    CLI::App* sub = app.add_subcommand(name, "(not available in this version)");
    sub->prefix_command();
    sub->callback([name, &action] {
      action = [name] {
        std::fprintf(stderr, "isochor: the command \"%s\" is not available in this version\n",
                     name);
        return static_cast<int>(kExitUsage);
      };
    });
  }
}

int run(int argc, char** argv) {
  CLI::App app{"Isochor: CAD surface editing that keeps volume, detail and continuity"};
  app.set_version_flag("--version", std::string("isochor ") + ISOCHOR_VERSION);
  app.require_subcommand(1);
  Common common;
  std::function<int()> action;

  InfoOptions info;
  CLI::App* sub = app.add_subcommand("info", "faces, joins, continuity, locks, unit, volume");
  sub->add_option("MODEL", info.model)->required();
  add_close(*sub, info.close);
  add_common(*sub, common);
  sub->callback([&] { action = [&] { return run_info(info, common); }; });

  VolumeOptions volume;
  sub = app.add_subcommand("volume", "signed volume with its error bound");
  sub->add_option("MODEL", volume.model)->required();
  sub->add_flag("--exact", volume.exact, "the rational number, for polynomial models");
  sub->add_flag("--open", volume.open, "the integral of z dx dy of an open model");
  sub->add_flag("--moments", volume.moments,
                "centroid, second moments, inertia and principal axes of a closed model");
  sub->add_option("--section", volume.section,
                  "area of the cross section by the plane NX x + NY y + NZ z = H")
      ->delimiter(',')
      ->expected(4)
      ->option_text("NX,NY,NZ,H");
  sub->add_option("--below", volume.below,
                  "volume and centroid of the part below a plane, with bounds: z=0.4, or "
                  "NX,NY,NZ,H for NX x + NY y + NZ z < H")
      ->option_text("PLANE");
  sub->add_option("--gradient", volume.gradient, "write dV/dx, dV/dy, dV/dz of every point");
  add_close(*sub, volume.close);
  add_common(*sub, common);
  sub->callback([&] { action = [&] { return run_volume(volume, common); }; });

  SuggestOptions suggest;
  sub = app.add_subcommand("suggest", "a ready-to-run edit at the freest place of the model");
  sub->add_option("MODEL", suggest.model)->required();
  sub->add_option("-o,--output", suggest.output, "edits file to write (default: stdout)");
  add_close(*sub, suggest.close);
  add_common(*sub, common);
  sub->callback([&] { action = [&] { return run_suggest(suggest, common); }; });

  EditOptions edit;
  sub = app.add_subcommand("edit", "apply edits; write the model, a report, a picture");
  sub->add_option("MODEL", edit.model)->required();
  sub->add_option("EDITS", edit.edits)->required();
  sub->add_option("-o,--output", edit.output, "model to write")->required();
  sub->add_option("--report", edit.report, "report to write (JSON)");
  sub->add_option("--picture", edit.picture, "picture to write (PNG): before, after, difference");
  sub->add_option("--html", edit.html, "page to write (HTML): numbers, checks and the picture");
  add_close(*sub, edit.close);
  add_common(*sub, common);
  sub->callback([&] { action = [&] { return run_edit(edit, common); }; });

  CheckOptions check;
  sub = app.add_subcommand("check", "validity, gaps, continuity, orientation, volume");
  sub->add_option("MODEL", check.model)->required();
  sub->add_option("--picture", check.picture,
                  "picture to write (PNG): edges by continuity, free edges red");
  sub->add_flag("--self-intersections", check.self_intersections,
                "also look for faces that cut through each other (CAD files)");
  sub->add_option("--against", check.against, "what changed since ORIGINAL, face by face");
  add_close(*sub, check.close);
  add_common(*sub, common);
  sub->callback([&] { action = [&] { return run_check(check, common); }; });

  ConvertOptions convert;
  sub = app.add_subcommand("convert", "between STEP, IGES, BREP, .isochor.json; to OBJ, STL, GLB");
  sub->add_option("IN", convert.input)->required();
  sub->add_option("OUT", convert.output)->required();
  sub->add_flag("--rewrite", convert.rewrite,
                "from STEP to STEP: let OpenCASCADE write the file anew instead of copying it");
  add_common(*sub, common);
  sub->callback([&] { action = [&] { return run_convert(convert, common); }; });

  RenderOptions render;
  sub = app.add_subcommand("render", "a picture without a display");
  sub->add_option("MODEL", render.model, "a model, or a mesh (OBJ)")->required();
  sub->add_option("-o,--output", render.output, "picture to write (PNG)")->required();
  sub->add_option("--compare", render.compare, "colour by the deviation from OTHER");
  add_common(*sub, common);
  sub->callback([&] { action = [&] { return run_render(render, common); }; });

  SolveOptions solve;
  sub = app.add_subcommand("solve", "edit parameters under linear constraints, exactly");
  sub->add_option("PROBLEM", solve.problem, "parameters, constraints, anchors (JSON)")->required();
  sub->add_option("-o,--output", solve.output,
                  "solution to write (JSON), also when the answer is no");
  add_common(*sub, common);
  sub->callback([&] { action = [&] { return run_solve(solve, common); }; });

  add_missing(app, action);

  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? kExitDone : kExitUsage;
  }
  cancel_on_signals(common.cancel);
  return action();
}

}  // namespace
}  // namespace isochor::app

namespace {

// Which option allows more.
const char* remedy(isochor::LimitError::Limit limit) {
  return limit == isochor::LimitError::Limit::kTime ? "--time-limit SECONDS"
                                                    : "--memory-limit MEGABYTES";
}

}  // namespace

int main(int argc, char** argv) {
  // Results and remarks keep their order also where both go to one file.
  std::setvbuf(stdout, nullptr, _IOLBF, BUFSIZ);
  try {
    return isochor::app::run(argc, argv);
  } catch (const isochor::CancelledError&) {
    std::fputs("isochor: cancelled\n", stderr);
    return isochor::app::kExitCancelled;
  } catch (const isochor::LimitError& error) {
    std::fprintf(stderr, "isochor: %s; %s allows more\n", error.what(), remedy(error.limit()));
    return isochor::app::kExitInput;
  } catch (const isochor::InputError& error) {
    std::fprintf(stderr, "isochor: %s\n", error.what());
    return isochor::app::kExitInput;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "isochor: internal error, please report it: %s\n", error.what());
    return isochor::app::kExitBug;
  }
}
