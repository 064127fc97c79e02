// SPDX-License-Identifier: BSD-3-Clause
// Reading MSH: 10^6 nodes and 5.8 million tetrahedra in each of the four variants. Bar: at most 2 s
// and 0.7 GB. Each variant is read in a process of its own, whose peak memory is then that of the
// reader; the rate of a plain read() of the same file stands beside it.
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <fstream>

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "roughmesh/mesh_io.hpp"

#include "support/files.hpp"
#include "support/msh_files.hpp"

using namespace roughmesh;

namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

// Cube of `divisions`^3 cells, each cut into six tetrahedra along its diagonal; four volumes and
// two sides are groups. Coordinates have 16 digits, as in real files.
Mesh make_cube(int divisions) {
  const int row = divisions + 1;
  const auto node = [&](int i, int j, int k) {
    return static_cast<Index>((k * row + j) * row + i);
  };
  Mesh mesh;
  for (int k = 0; k < row; ++k)
    for (int j = 0; j < row; ++j)
      for (int i = 0; i < row; ++i) mesh.nodes.emplace_back(i / 3.0, j / 7.0, k / 11.0);
  for (Index i = 0; i < mesh.n_nodes(); ++i) mesh.node_tags.push_back(i + 1);
  std::vector<ElementBlock> volumes(4);
  const std::array<std::array<int, 3>, 6> paths = {
      {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {0, 2, 1}, {2, 1, 0}, {1, 0, 2}}};
  for (int k = 0; k < divisions; ++k)
    for (int j = 0; j < divisions; ++j)
      for (int i = 0; i < divisions; ++i)
        for (const auto& path : paths) {
          std::array<int, 3> corner = {i, j, k};
          auto& nodes = volumes[static_cast<std::size_t>(4 * k / divisions)].nodes;
          nodes.push_back(node(i, j, k));
          for (const int axis : path) {
            ++corner[static_cast<std::size_t>(axis)];
            nodes.push_back(node(corner[0], corner[1], corner[2]));
          }
        }
  Tag tag = 0;
  for (std::size_t v = 0; v < volumes.size(); ++v) {
    volumes[v].type = {ElementShape::tetrahedron, 1, 4};
    volumes[v].entity = static_cast<Tag>(v) + 1;
    volumes[v].physical_groups = {static_cast<Tag>(v) + 1};
    volumes[v].tags.resize(volumes[v].nodes.size() / 4);
    for (Tag& number : volumes[v].tags) number = ++tag;
    mesh.groups.push_back({3, static_cast<Tag>(v) + 1, fmt::format("volume {}", v)});
  }
  mesh.blocks = std::move(volumes);
  return mesh;
}

// Runs the action in a child process and returns what it returns, by way of a pipe.
template <typename Result, typename Action>
Result in_child(Action action) {
  std::array<int, 2> ends{};
  if (::pipe(ends.data()) != 0) std::abort();
  Result result{};
  const pid_t child = ::fork();
  if (child == 0) {
    result = action();
    ::_exit(::write(ends[1], &result, sizeof result) == sizeof result ? 0 : 1);
  }
  ::close(ends[1]);
  const bool is_whole = ::read(ends[0], &result, sizeof result) == sizeof result;
  ::close(ends[0]);
  ::waitpid(child, nullptr, 0);
  if (!is_whole) std::abort();
  return result;
}

rusage usage() {
  rusage result{};
  ::getrusage(RUSAGE_SELF, &result);
  return result;
}

double processor_seconds(const rusage& used) {
  const auto seconds = [](const timeval& time) {
    return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
  };
  return seconds(used.ru_utime) + seconds(used.ru_stime);
}

double plain_read_seconds(const std::filesystem::path& path) {
  const std::size_t size = std::filesystem::file_size(path);
  const auto start = Clock::now();
  const auto bytes = std::make_unique_for_overwrite<char[]>(size);
  const int file = ::open(path.c_str(), O_RDONLY);
  std::size_t done = 0;
  for (ssize_t n = 1; done < size && n > 0; done += static_cast<std::size_t>(n))
    n = ::read(file, bytes.get() + done, size - done);
  ::close(file);
  return seconds_since(start);
}

struct Reading {
  double seconds, processor_seconds, gigabytes;
  std::int64_t n_nodes, n_elements;
};

Reading read_once(const std::filesystem::path& path) {
  const auto start = Clock::now();
  const Mesh mesh = read_mesh(path);
  const double seconds = seconds_since(start);
  const rusage used = usage();  // the process has done nothing else
  return {seconds, processor_seconds(used), static_cast<double>(used.ru_maxrss) * 1024e-9,
          mesh.n_nodes(), n_elements(mesh)};
}

double patch_seconds(const std::filesystem::path& path) {
  Mesh mesh = read_mesh(path);
  for (Vec3& x : mesh.nodes) x *= 1 + 1e-3;
  const auto start = Clock::now();
  write_mesh(mesh, path);
  return seconds_since(start);
}

void report(const test::TemporaryFolder& folder, int divisions, const test::MshStyle& style) {
  const std::filesystem::path path = folder / "cube.msh";
  in_child<int>([&] {
    test::write_bytes(path, test::msh_bytes(make_cube(divisions), style));
    return 0;
  });
  const double megabytes = static_cast<double>(std::filesystem::file_size(path)) * 1e-6;
  const double plain = in_child<double>([&] { return plain_read_seconds(path); });
  const Reading reading = in_child<Reading>([&] { return read_once(path); });
  const double patch = in_child<double>([&] { return patch_seconds(path); });
  std::printf(
      "%-23s %5.0f %9lld %9lld | %6.2f %6.2f %6.0f %6.2f | %6.2f %6.0f %7.1f | %6.2f %6.0f\n",
      name(style).c_str(), megabytes, static_cast<long long>(reading.n_nodes),
      static_cast<long long>(reading.n_elements), reading.seconds, reading.processor_seconds,
      megabytes / reading.seconds, reading.gigabytes, plain, megabytes / plain,
      reading.seconds / plain, patch, megabytes / patch);
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
  const int divisions = argc > 1 ? std::atoi(argv[1]) : 99;
  const test::TemporaryFolder folder;
  std::printf("%-23s %5s %9s %9s | %6s %6s %6s %6s | %6s %6s %7s | %6s %6s\n", "", "", "", "",
              "read", "cpu", "", "peak", "read()", "", "ratio", "write", "");
  std::printf("%-23s %5s %9s %9s | %6s %6s %6s %6s | %6s %6s %7s | %6s %6s\n", "variant", "MB",
              "nodes", "elements", "s", "s", "MB/s", "GB", "s", "MB/s", "", "s", "MB/s");
  for (const test::MshStyle& style : test::all_msh_styles()) report(folder, divisions, style);
}
