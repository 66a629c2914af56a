// Measures reading and analysing real files against OpenCASCADE's own reading of them, and the
// volume against OpenCASCADE's at 1e-9; prints Markdown tables.
//
// usage: isochor_import_performance FILE...
// Exit status: 0 measured, 2 usage, 3 a file cannot be read.
#include <sys/resource.h>

#include <BRepGProp.hxx>
#include <BRepTools.hxx>
#include <BRep_Builder.hxx>
#include <GProp_GProps.hxx>
#include <IGESControl_Reader.hxx>
#include <STEPControl_Reader.hxx>
#include <TopoDS_Shape.hxx>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "isochor/base/error.h"
#include "isochor/step/bridge.h"
#include "isochor/step/document.h"
#include "isochor/step/flux.h"
#include "isochor/step/solid_model.h"
#include "machine.h"
#include "timing.h"

namespace isochor::bench {
namespace {

constexpr double kEps = 1e-9;
constexpr int kRepetitions = 5;

double children_cpu_seconds() {
  rusage usage{};
  getrusage(RUSAGE_CHILDREN, &usage);
  const auto value = [](const timeval& t) {
    return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
  };
  return value(usage.ru_utime) + value(usage.ru_stime);
}

// The least processor time of child processes that `work` starts: each reads as if for the first
// time.
double best_child_seconds(const std::function<void()>& work) {
  double best = std::numeric_limits<double>::infinity();
  for (int k = 0; k < kRepetitions; ++k) {
    const double begin = children_cpu_seconds();
    work();
    best = std::min(best, children_cpu_seconds() - begin);
  }
  return best;
}

// The shortest program that gets a shape out of the file: no names, no colours, no checks.
void read_with_occt(const std::string& path) {
  switch (internal::format_of(path)) {
    case internal::FileFormat::kStep: {
      STEPControl_Reader reader;
      reader.ReadFile(path.c_str());
      reader.TransferRoots();
      if (reader.OneShape().IsNull()) throw InputError(path, "", "has no shape");
      return;
    }
    case internal::FileFormat::kIges: {
      IGESControl_Reader reader;
      reader.ReadFile(path.c_str());
      reader.TransferRoots();
      if (reader.OneShape().IsNull()) throw InputError(path, "", "has no shape");
      return;
    }
    case internal::FileFormat::kBrep: {
      TopoDS_Shape shape;
      if (!BRepTools::Read(shape, path.c_str(), BRep_Builder())) {
        throw InputError(path, "", "has no shape");
      }
    }
  }
}

void print_import_row(const std::string& path) {
  const double occt = best_child_seconds([&] {
    run_in_child(path, [&] {
      read_with_occt(path);
      return std::string();
    });
  });
  const double documents = best_child_seconds([&] {
    run_in_child(path, [&] {
      internal::load_document(path);
      return std::string();
    });
  });
  SolidModel model;
  const double ours = best_child_seconds([&] { model = read_solid(path); });
  std::printf("| %s | %zu | %.0f | %.0f | %.0f | %.2f |\n",
              std::filesystem::path(path).filename().c_str(), model.faces.size(), 1e3 * occt,
              1e3 * documents, 1e3 * ours, ours / occt);
  std::fflush(stdout);
}

void print_volume_row(const std::string& path) {
  const internal::Document document = internal::load_document(path);
  const Patience patience{2, 0.2};
  internal::ShapeIntegrals integrals;
  const double ours = best_seconds(
      CLOCK_PROCESS_CPUTIME_ID, [&] { integrals = internal::integrate_shape(document.shape); },
      patience);
  GProp_GProps properties;
  double reached = 0.0;
  const double occt = best_seconds(
      CLOCK_PROCESS_CPUTIME_ID,
      [&] {
        properties = GProp_GProps();
        reached = BRepGProp::VolumeProperties(document.shape, properties, kEps);
      },
      patience);
  std::printf("| %s | %.1f | %.1f | %.1f | %.17g | %.17g | %.1e |\n",
              std::filesystem::path(path).filename().c_str(), 1e3 * ours, 1e3 * occt, occt / ours,
              integrals.volume, properties.Mass(), reached);
  std::fflush(stdout);
}

int run(const std::vector<std::string>& paths) {
  std::printf("%s, %s, load %s\n\n", processor_name().c_str(), compiler_name().c_str(),
              load_average().c_str());
  std::printf(
      "| file | faces | OpenCASCADE reads (ms) | with names, structure (ms) | read and analysed "
      "(ms) | ratio |\n|---|---|---|---|---|---|\n");
  for (const auto& path : paths) print_import_row(path);
  std::printf(
      "\n| file | volume (ms) | OpenCASCADE, 1e-9 (ms) | ratio | volume | OpenCASCADE's | error it "
      "states |\n|---|---|---|---|---|---|---|\n");
  for (const auto& path : paths) print_volume_row(path);
  return 0;
}

}  // namespace
}  // namespace isochor::bench

int main(int count, char** arguments) {
  if (count < 2) {
    std::fputs("usage: isochor_import_performance FILE...\n", stderr);
    return 2;
  }
  try {
    return isochor::bench::run({arguments + 1, arguments + count});
  } catch (const isochor::InputError& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 3;
  }
}
