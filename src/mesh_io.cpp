// SPDX-License-Identifier: BSD-3-Clause
#include "roughmesh/mesh_io.hpp"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <memory>
#include <new>
#include <system_error>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include "file_formats.hpp"
#include "hash.hpp"
#include "io_patch.hpp"

namespace roughmesh {
namespace detail {
namespace {

class Descriptor {
 public:
  explicit Descriptor(int number) : number_(number) {}
  ~Descriptor() {
    if (number_ >= 0) ::close(number_);
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  int number() const { return number_; }

 private:
  int number_;
};

[[noreturn]] void fail_to_read(const std::filesystem::path& path, int error) {
  const char* const remedy = error == ENOENT || error == ENOTDIR ? "check the path"
                             : error == EACCES                   ? "ask for permission to read it"
                                                                 : "choose another file";
  throw InputError(fmt::format("{}: cannot be read: {}; {}", path.string(),
                               std::generic_category().message(error), remedy));
}

std::size_t size_of_regular_file(const std::filesystem::path& path, int descriptor) {
  struct stat facts {};
  if (::fstat(descriptor, &facts) != 0) fail_to_read(path, errno);
  if (S_ISDIR(facts.st_mode))
    throw InputError(fmt::format("{}: is a directory; name a mesh file in it", path.string()));
  if (!S_ISREG(facts.st_mode))
    throw InputError(
        fmt::format("{}: is a pipe or device; save it to a file first", path.string()));
  return static_cast<std::size_t>(facts.st_size);
}

}  // namespace

FileBytes read_file(const std::filesystem::path& path) {
  // Without O_NONBLOCK, opening a pipe that nobody writes to would wait for ever.
  const Descriptor descriptor(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK));
  if (descriptor.number() < 0) fail_to_read(path, errno);
  const std::size_t size = size_of_regular_file(path, descriptor.number());
  FileBytes file{path, std::make_unique_for_overwrite<char[]>(size + 1), 0};
  while (file.size < size) {
    const ssize_t n = ::read(descriptor.number(), file.data.get() + file.size, size - file.size);
    if (n < 0 && errno != EINTR) fail_to_read(path, errno);
    if (n == 0) break;
    if (n > 0) file.size += static_cast<std::size_t>(n);
  }
  file.data[file.size] = '\0';
  return file;
}

namespace {

std::string extension(const std::filesystem::path& path) {
  std::string text = path.extension().string();
  std::transform(text.begin(), text.end(), text.begin(),
                 [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c; });
  return text;
}

bool begins_msh(std::string_view bytes) {
  const std::size_t start = bytes.find_first_not_of(" \t\r\n");
  return start != bytes.npos && bytes[start] == '$';
}

[[noreturn]] void refuse_unknown(const FileBytes& file) {
  const std::string path = file.path.string();
  const std::string end = extension(file.path);
  if (end == ".msh")
    throw FormatError(path +
                      ":1: does not begin with $MeshFormat, so it is no MSH file; mesh a "
                      "geometry script with gmsh -3 first");
  if (end == ".stl")
    throw FormatError(
        fmt::format("{}: byte {}: neither begins with \"solid\" nor has the size that "
                    "its number of triangles asks for: it is cut short or no STL",
                    path, file.size));
  throw InputError(path + ": of a kind that is not read; convert it to MSH, STL or PLY2");
}

Mesh read_by_content(FileBytes file) {
  const std::string_view bytes = file.view();
  if (bytes.empty())
    throw FormatError(file.path.string() + ":1: the file is empty; save the mesh again");
  if (begins_msh(bytes)) return read_msh(std::move(file));
  // Before text, since headers of binary files like to begin with "solid" too.
  if (is_binary_stl(bytes)) return read_binary_stl(std::move(file));
  if (is_text_stl(bytes)) return read_text_stl(std::move(file));
  if (extension(file.path) == ".ply2") return read_ply2(std::move(file));
  refuse_unknown(file);
}

const char* usual_extension(MeshFormat format) {
  switch (format) {
    case MeshFormat::stl:
      return ".stl";
    case MeshFormat::ply2:
      return ".ply2";
    default:
      return ".msh";
  }
}

enum class Writer { patch, patch_stl, new_msh4, vtu };

Writer writer_of_patches(MeshFormat format) {
  return format == MeshFormat::stl ? Writer::patch_stl : Writer::patch;
}

// A mesh that is no longer the one that was read, apart from positions, is as if made in memory.
Writer writer_of_msh_or_source_format(const Mesh& mesh, const std::filesystem::path& path) {
  const std::string end = extension(path);
  const bool is_changed = mesh.source != nullptr && mesh.source->topology != topology_hash(mesh);
  const bool is_new = mesh.source == nullptr || is_changed;
  const char* const usual = usual_extension(is_new ? MeshFormat::none : mesh.format);
  // Whatever a file was called when it was read it may be called when it is written.
  if (end == usual || (!is_new && end == extension(mesh.source->file.path)))
    return is_new ? Writer::new_msh4 : writer_of_patches(mesh.format);
  throw InputError(fmt::format(
      "{}: extension \"{}\" is not written from this mesh{}; use {} or .vtu", path.string(), end,
      is_changed ? ", of which more than positions was changed" : "", usual));
}

// Refuses what cannot be written whatever the positions are.
Writer choose_writer(const Mesh& mesh, const std::filesystem::path& path) {
  const Writer writer =
      extension(path) == ".vtu" ? Writer::vtu : writer_of_msh_or_source_format(mesh, path);
  if (writer == Writer::vtu) check_for_vtu(mesh, path);
  if (writer == Writer::new_msh4) check_for_msh4(mesh, path);
  return writer;
}

void check_finite(const Mesh& mesh, const std::filesystem::path& path) {
  for (std::size_t i = 0; i < mesh.nodes.size(); ++i)
    if (!mesh.nodes[i].allFinite())
      throw InputError(
          fmt::format("{}: node {} has a position that is not finite; check the displacement",
                      path.string(), i < mesh.node_tags.size() ? mesh.node_tags[i] : Tag(i)));
}

void write_with(Writer writer, const Mesh& mesh, const std::vector<PointField>& fields,
                OutputFile& output) {
  switch (writer) {
    case Writer::patch:
      return write_patched(mesh, output);
    case Writer::patch_stl:
      return write_patched_stl(mesh, output);
    case Writer::new_msh4:
      return write_new_msh4(mesh, output);
    case Writer::vtu:
      return write_vtu(mesh, fields, output);
  }
}

}  // namespace
}  // namespace detail

Mesh read_mesh(const std::filesystem::path& path) {
  try {
    return detail::read_by_content(detail::read_file(path));
  } catch (const std::bad_alloc&) {
    throw InputError(path.string() + ": too little memory to read it; free some or split the mesh");
  }
}

void write_mesh(const Mesh& mesh, const std::filesystem::path& path,
                const std::vector<PointField>& fields) {
  const detail::Writer writer = detail::choose_writer(mesh, path);
  detail::check_finite(mesh, path);
  detail::OutputFile output(path);
  detail::write_with(writer, mesh, fields, output);
  output.commit();
}

void write_text(const std::string& text, const std::filesystem::path& path) {
  detail::OutputFile output(path);
  output.write(text);
  output.commit();
}

void check_output(const Mesh& mesh, const std::filesystem::path& path) {
  detail::choose_writer(mesh, path);
  check_text_output(path);
}

void check_text_output(const std::filesystem::path& path) {
  // Whoever reads a pipe would take the end of the trial for the end of the file.
  std::error_code ignored;
  if (std::filesystem::is_fifo(path, ignored)) return;
  const detail::OutputFile trial(path);
}

std::string checksum(const Mesh& mesh) {
  if (mesh.source == nullptr) return {};
  return fmt::format("{:016x}", detail::hash(mesh.source->file.view()));
}

double coordinate_spacing(const Mesh& mesh) {
  double largest = 0;
  for (const Vec3& x : mesh.nodes) largest = std::max(largest, x.lpNorm<Eigen::Infinity>());
  const bool is_float =
      mesh.source != nullptr && mesh.source->coordinates == detail::NumberFormat::float32;
  const int digits = is_float ? 23 : 52;
  const int least_exponent = is_float ? -126 : -1022;  // below, the spacing no longer shrinks
  return std::ldexp(1.0, std::max(std::ilogb(largest), least_exponent) - digits);
}

}  // namespace roughmesh
