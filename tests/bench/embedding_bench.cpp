// Times and quality of the embedding alone: no decoding of images, no atlas, no output.
//
//   bench_embedding [--objective NAME] [--quality NAME] [--threads N] [--runs N] [--reference STEPS] [--json FILE]
//   MODEL…
//
// For each model: triangles; the paper's t1, t2, t3 in milliseconds (of the run with the median total); CPU seconds;
// the process' memory at its peak while the embedding ran; folded triangles; the paper's "Minimum"; the distortion
// measures; and with --reference (objective isometric) how far, in percent, the energy is above the local minimum that
// the reference solver finds from there within so many steps (+ where it has not converged). Models that are not a
// closed surface of genus 0 are named and passed over.
#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>
#include <ctime>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "bench/read_surface.h"
#include "bench/reference_solver.h"
#include "core/sphere/certificate.h"
#include "core/sphere/distortion.h"
#include "core/sphere/embedding.h"
#include "core/sphere/snap.h"

using namespace orbis;

namespace {

struct Arguments {
  Options options;
  int runs = 3;
  int reference_steps = 0;
  std::string json;
  std::vector<std::string> models;
};

Arguments parse(int count, char** values) {
  Arguments out;
  for (int i = 1; i < count; ++i) {
    const std::string word = values[i];
    if (word.starts_with("--") && i + 1 < count) {
      const std::string value = values[++i];
      if (word == "--runs") {
        out.runs = std::stoi(value);
      } else if (word == "--reference") {
        out.reference_steps = std::stoi(value);
      } else if (word == "--json") {
        out.json = value;
      } else {
        set_option(out.options, word.substr(2), value);
      }
    } else {
      out.models.push_back(word);
    }
  }
  return out;
}

struct Run {
  sphere::Embedding embedding;
  double wall = 0, cpu = 0;
  std::uint64_t peak_kb = 0;
};

// The kernel's high-water mark of resident memory can be set back to what is in use now.
void forget_peak() { std::ofstream("/proc/self/clear_refs") << "5"; }

std::uint64_t peak_kb() {
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);) {
    if (line.starts_with("VmHWM:")) return std::stoull(line.substr(6));
  }
  return 0;
}

Run run_once(const mesh::TriangleMesh& mesh, const Options& options) {
  NoProgress progress;
  Run out;
  forget_peak();
  const auto wall = std::chrono::steady_clock::now();
  const std::clock_t cpu = std::clock();
  NoCheckpoints none;
  out.embedding = sphere::embed(mesh, options, options.threads, progress, none);
  out.cpu = static_cast<double>(std::clock() - cpu) / CLOCKS_PER_SEC;
  out.wall = std::chrono::duration<double>(std::chrono::steady_clock::now() - wall).count();
  out.peak_kb = peak_kb();
  return out;
}

nlohmann::ordered_json measure(const std::string& path, const Arguments& arguments) {
  const mesh::TriangleMesh mesh = bench::read_surface(path);
  std::vector<Run> runs;
  for (int i = 0; i < arguments.runs; ++i) runs.push_back(run_once(mesh, arguments.options));
  std::ranges::sort(runs, {}, &Run::wall);
  const Run& median = runs[runs.size() / 2];
  const sphere::Snapped snapped = sphere::snap(median.embedding.points, mesh.triangles);
  std::vector<Vec3f> points;
  for (const sphere::GridPoint& p : snapped.points) points.push_back(sphere::from_grid(p));
  const sphere::Certificate certificate = sphere::certify(points, mesh.triangles);
  const sphere::Distortion d = sphere::measure_distortion(mesh, points);
  nlohmann::ordered_json out{{"model", path.substr(path.rfind('/') + 1)},
                             {"triangles", mesh.triangles.size()},
                             {"t1_ms", median.embedding.t1_ms},
                             {"t2_ms", median.embedding.t2_ms},
                             {"t3_ms", median.embedding.t3_ms},
                             {"wall_s", median.wall},
                             {"cpu_s", median.cpu},
                             {"peak_rss_mb", median.peak_kb / 1024},
                             {"folded", certificate.folded},
                             {"certified", certificate.valid},
                             {"converged", median.embedding.converged},
                             {"minimum", sphere::shape_preserving_energy(mesh, median.embedding.points)},
                             {"qc_mean", d.quasi_conformal_mean},
                             {"qc_p99", d.quasi_conformal_p99},
                             {"log_area_deviation", d.log_area_deviation},
                             {"symmetric_dirichlet", d.symmetric_dirichlet},
                             {"l2_stretch", d.l2_stretch}};
  if (arguments.reference_steps > 0) {
    const bench::Reference r = bench::converge(mesh, median.embedding.points, arguments.reference_steps);
    out["above_minimum_percent"] = 100 * (r.energy_before / r.energy_after - 1);
    out["reference_converged"] = r.converged;
  }
  return out;
}

std::string above_minimum(const nlohmann::ordered_json& row) {
  if (!row.contains("above_minimum_percent")) return "";
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.2f%s", row["above_minimum_percent"].get<double>(),
                row["reference_converged"].get<bool>() ? "" : "+");
  return text.data();
}

} // namespace

int main(int count, char** values) {
  const Arguments arguments = parse(count, values);
  nlohmann::ordered_json all = nlohmann::ordered_json::array();
  std::printf(
      "| model | triangles | t1 ms | t2 ms | t3 ms | CPU s | MB | folded | Minimum | qc mean | qc p99 | log area | "
      "sym. Dirichlet | L2 stretch | above minimum, %% |\n|%s\n",
      " --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |");
  for (const std::string& model : arguments.models) {
    try {
      const nlohmann::ordered_json r = measure(model, arguments);
      std::printf("| %s | %zu | %.0f | %.0f | %.0f | %.2f | %d | %d | %.2f | %.2f | %.1f | %.2f | %.3f | %.3f | %s |\n",
                  r["model"].get<std::string>().c_str(), r["triangles"].get<std::size_t>(), r["t1_ms"].get<double>(),
                  r["t2_ms"].get<double>(), r["t3_ms"].get<double>(), r["cpu_s"].get<double>(),
                  r["peak_rss_mb"].get<int>(), r["folded"].get<int>(), r["minimum"].get<double>(),
                  r["qc_mean"].get<double>(), r["qc_p99"].get<double>(), r["log_area_deviation"].get<double>(),
                  r["symmetric_dirichlet"].get<double>(), r["l2_stretch"].get<double>(), above_minimum(r).c_str());
      all.push_back(r);
    } catch (const Error& e) {
      std::fprintf(stderr, "%s: passed over: %s\n", model.c_str(), e.message().c_str());
    }
    std::fflush(stdout);
  }
  if (!arguments.json.empty()) std::ofstream(arguments.json) << all.dump(2) << '\n';
  return all.empty() ? 1 : 0;
}
