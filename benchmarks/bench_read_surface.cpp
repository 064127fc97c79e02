// SPDX-License-Identifier: BSD-3-Clause
// Reading surfaces: PLY and STL with 10^6 nodes and 2 * 10^6 triangles. Bar: binary in at most 1 s.
// Best of three readings, each beside a plain read() of the same bytes.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <memory>

#include <fcntl.h>
#include <unistd.h>

#include "roughmesh/mesh_io.hpp"

#include "support/files.hpp"
#include "support/meshes.hpp"

using namespace roughmesh;

namespace {

struct Best {
  double seconds = 1e30;
  double processor_seconds = 1e30;  // of all threads; what counts where other programs run as well
};

template <typename Action>
Best best_of_three(Action action) {
  using Clock = std::chrono::steady_clock;
  Best best;
  for (int k = 0; k < 3; ++k) {
    const auto start = Clock::now();
    const std::clock_t processor_start = std::clock();
    action();
    const auto ticks = static_cast<double>(std::clock() - processor_start);
    best.processor_seconds = std::min(best.processor_seconds, ticks / CLOCKS_PER_SEC);
    best.seconds =
        std::min(best.seconds, std::chrono::duration<double>(Clock::now() - start).count());
  }
  return best;
}

void plain_read(const std::filesystem::path& path) {
  const std::size_t size = std::filesystem::file_size(path);
  const auto bytes = std::make_unique_for_overwrite<char[]>(size);
  const int file = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  std::size_t done = 0;
  for (ssize_t n = 1; done < size && n > 0; done += static_cast<std::size_t>(n))
    n = ::read(file, bytes.get() + done, size - done);
  ::close(file);
}

// A wavy plate: no two coordinates are alike, as on real surfaces.
Mesh make_surface(int divisions) {
  Mesh mesh = test::plate(divisions);
  for (Vec3& x : mesh.nodes)
    x += Vec3(1e-4 * std::sin(7 * x[1]), 1e-4 * std::cos(9 * x[0]), std::sin(5 * x[0] + 3 * x[1]));
  return mesh;
}

void report(const std::filesystem::path& path, const char* variant) {
  Mesh mesh;
  const double plain = best_of_three([&] { plain_read(path); }).seconds;
  const Best reading = best_of_three([&] { mesh = read_mesh(path); });
  const double megabytes = static_cast<double>(std::filesystem::file_size(path)) * 1e-6;
  std::printf("%-12s %5.0f %9d %9lld | %6.2f %6.2f %6.0f | %6.3f %6.0f %7.1f\n", variant, megabytes,
              mesh.n_nodes(), static_cast<long long>(n_elements(mesh)), reading.seconds,
              reading.processor_seconds, megabytes / reading.seconds, plain, megabytes / plain,
              reading.seconds / plain);
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
  const int divisions = argc > 1 ? std::atoi(argv[1]) : 1000;
  const test::TemporaryFolder folder;
  std::printf("%-12s %5s %9s %9s | %6s %6s %6s | %6s %6s %7s\n", "", "", "", "", "read", "cpu", "",
              "read()", "", "ratio");
  std::printf("%-12s %5s %9s %9s | %6s %6s %6s | %6s %6s\n", "variant", "MB", "nodes", "elements",
              "s", "s", "MB/s", "s", "MB/s");
  const Mesh mesh = make_surface(divisions);
  for (const char* const extension : {"ply", "stl", "obj", "off"})
    for (const Encoding encoding : {Encoding::binary, Encoding::text}) {
      const bool has_binary = extension[0] == 'p' || extension[0] == 's';
      if (encoding == Encoding::binary && !has_binary) continue;
      const std::filesystem::path path = folder / ("surface." + std::string(extension));
      write_mesh(mesh, path, {.encoding = encoding});
      const std::string variant =
          std::string(extension) + (encoding == Encoding::binary ? " binary" : " text");
      report(path, variant.c_str());
    }
}
