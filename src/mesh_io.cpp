// SPDX-License-Identifier: BSD-3-Clause
#include "roughmesh/mesh_io.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <new>
#include <system_error>

#include <fmt/format.h>

#include "file_formats.hpp"
#include "hash.hpp"

namespace roughmesh {
namespace {

using detail::FileFormat;

// How a mesh goes into a file.
struct WritePlan {
  const FileFormat* format = nullptr;
  bool copies_source = false;
  WriteOptions options;
};

// A mesh that is no longer the one that was read, apart from positions, is as if made in memory.
bool is_as_read(const Mesh& mesh) {
  return mesh.source != nullptr && mesh.source->topology == detail::topology_hash(mesh);
}

bool has_extension(const FileFormat& format, std::string_view extension) {
  return std::count(format.extensions.begin(), format.extensions.end(), extension) > 0;
}

std::string written_extensions() {
  std::string list;
  for (const FileFormat* format : detail::file_formats())
    if (format->write_new != nullptr && list.find(format->extensions.front()) == list.npos)
      list += fmt::format("{}{}", list.empty() ? "" : ", ", format->extensions.front());
  return list;
}

const FileFormat& choose_format(const Mesh& mesh, const std::filesystem::path& path,
                                const WriteOptions& options) {
  if (options.format && *options.format != MeshFormat::none)
    return detail::file_format(*options.format);
  const std::string extension = detail::lower_extension(path);
  if (mesh.source != nullptr) {
    const FileFormat& own = detail::file_format(mesh.format);
    // Whatever a file was called when it was read it may be called when it is written.
    const bool is_own = has_extension(own, extension) ||
                        extension == detail::lower_extension(mesh.source->file.path);
    if (is_own && (is_as_read(mesh) || own.write_new != nullptr)) return own;
  }
  for (const FileFormat* format : detail::file_formats())
    if (has_extension(*format, extension) && format->write_new != nullptr) return *format;
  throw InputError(fmt::format(
      "{}: extension \"{}\" is not written from this mesh{}; use one of {}", path.string(),
      extension,
      mesh.source != nullptr && !is_as_read(mesh) ? ", of which more than positions was changed"
                                                  : "",
      written_extensions()));
}

void require_encoding(const FileFormat& format, Encoding encoding,
                      const std::filesystem::path& path) {
  if (std::count(format.encodings.begin(), format.encodings.end(), encoding) > 0) return;
  throw InputError(fmt::format("{}: {} files are not written in {}; leave the choice out",
                               path.string(), name(format.format),
                               encoding == Encoding::text ? "text" : "binary"));
}

Encoding source_encoding(const Mesh& mesh) {
  return mesh.source->coordinates == detail::NumberFormat::text ? Encoding::text : Encoding::binary;
}

// That of the source where the format stays.
Encoding usual_encoding(const Mesh& mesh, const FileFormat& format) {
  if (mesh.source != nullptr && mesh.format == format.format) {
    const auto& encodings = format.encodings;
    if (std::count(encodings.begin(), encodings.end(), source_encoding(mesh)) > 0)
      return source_encoding(mesh);
  }
  return format.encodings.front();
}

// Refuses what cannot be written whatever the positions are.
WritePlan make_plan(const Mesh& mesh, const std::filesystem::path& path,
                    const WriteOptions& options) {
  WritePlan plan{&choose_format(mesh, path, options), false, options};
  if (is_as_read(mesh) && plan.format->format == mesh.format) {
    const Encoding encoding = source_encoding(mesh);
    plan.copies_source = options.encoding.value_or(encoding) == encoding;
  }
  if (plan.copies_source) return plan;
  if (plan.format->write_new == nullptr)
    throw InputError(fmt::format("{}: {} is only written from a mesh that was read as {}; use .msh",
                                 path.string(), name(plan.format->format),
                                 name(plan.format->format)));
  plan.options.encoding = options.encoding.value_or(usual_encoding(mesh, *plan.format));
  require_encoding(*plan.format, *plan.options.encoding, path);
  detail::check_arrays(mesh, path);
  plan.format->check_new(mesh, path);
  return plan;
}

void check_fields(const Mesh& mesh, const std::filesystem::path& path,
                  const std::vector<PointField>& fields) {
  for (const PointField& field : fields)
    if (field.n_components < 1 ||
        field.values.size() != mesh.nodes.size() * static_cast<std::size_t>(field.n_components))
      throw InputError(fmt::format("{}: field {} has {} values where {} nodes with {} each are due",
                                   path.string(), field.name, field.values.size(), mesh.n_nodes(),
                                   field.n_components));
}

void check_finite(const Mesh& mesh, const std::filesystem::path& path) {
  for (std::size_t i = 0; i < mesh.nodes.size(); ++i)
    if (!mesh.nodes[i].allFinite())
      throw InputError(
          fmt::format("{}: node {} has a position that is not finite; check the displacement",
                      path.string(), i < mesh.node_tags.size() ? mesh.node_tags[i] : Tag(i)));
}

std::ptrdiff_t n_named(const Mesh& mesh) {
  return std::count_if(mesh.groups.begin(), mesh.groups.end(),
                       [](const PhysicalGroup& group) { return !group.name.empty(); });
}

bool has_element_in_several_groups(const Mesh& mesh) {
  return std::any_of(mesh.blocks.begin(), mesh.blocks.end(), [](const ElementBlock& block) {
    return block.size() > 0 && block.physical_groups.size() > 1;
  });
}

std::int64_t n_quadrangles(const Mesh& mesh) {
  std::int64_t n = 0;
  for (const ElementBlock& block : mesh.blocks)
    if (block.type.shape == ElementShape::quadrangle) n += block.size();
  return n;
}

void add_lost_elements(const Mesh& mesh, const detail::Holds& holds,
                       std::vector<std::string>& losses) {
  constexpr std::array things = {"points", "lines", "surface elements", "volume elements"};
  for (int dim = 0; dim <= 3; ++dim) {
    const std::int64_t n = n_elements(mesh, dim);
    if (n > 0 && (dim < holds.least_dimension || dim > holds.most_dimension))
      losses.push_back(fmt::format("{} {}", n, things[static_cast<std::size_t>(dim)]));
  }
  const std::int64_t n = n_quadrangles(mesh);
  if (n > 0 && !holds.quadrangles)
    losses.push_back(fmt::format("{} quadrangles, which become two triangles each", n));
}

// Numbers that are not 1, 2, 3, ... in the order of the arrays.
bool has_own_numbers(const Mesh& mesh) {
  for (std::size_t i = 0; i < mesh.node_tags.size(); ++i)
    if (mesh.node_tags[i] != static_cast<Tag>(i) + 1) return true;
  return false;
}

}  // namespace

Mesh read_mesh(const std::filesystem::path& path) {
  try {
    detail::FileBytes file = detail::read_file(path);
    const FileFormat& format = detail::recognize(file);
    return format.read(std::move(file));
  } catch (const std::bad_alloc&) {
    throw InputError(path.string() + ": too little memory to read it; free some or split the mesh");
  }
}

void write_mesh(const Mesh& mesh, const std::filesystem::path& path, const WriteOptions& options) {
  const WritePlan plan = make_plan(mesh, path, options);
  check_fields(mesh, path, options.fields);
  check_finite(mesh, path);
  detail::OutputFile output(path);
  if (plan.copies_source)
    plan.format->write_patched(mesh, output);
  else
    plan.format->write_new(mesh, plan.options, output);
  output.commit();
}

namespace {

const detail::Holds& holds_of(const WritePlan& plan) {
  const bool is_text = plan.options.encoding == Encoding::text;
  return is_text && plan.format->text_holds ? *plan.format->text_holds : plan.format->holds;
}

double spacing_at(const Mesh& mesh, bool is_float) {
  double largest = 0;
  for (const Vec3& x : mesh.nodes) largest = std::max(largest, x.lpNorm<Eigen::Infinity>());
  const int digits = is_float ? 23 : 52;
  const int least_exponent = is_float ? -126 : -1022;  // below, the spacing no longer shrinks
  return std::ldexp(1.0, std::max(std::ilogb(largest), least_exponent) - digits);
}

}  // namespace

std::vector<std::string> conversion_losses(const Mesh& mesh, const std::filesystem::path& path,
                                           const WriteOptions& options) {
  const WritePlan plan = make_plan(mesh, path, options);
  std::vector<std::string> losses;
  if (plan.copies_source) return losses;
  const detail::Holds& holds = holds_of(plan);
  add_lost_elements(mesh, holds, losses);
  if (!mesh.groups.empty() && !holds.groups)
    losses.push_back(fmt::format("{} physical groups", mesh.groups.size()));
  if (n_named(mesh) > 0 && holds.groups && !holds.group_names)
    losses.push_back(fmt::format("names of {} physical groups", n_named(mesh)));
  if (!mesh.groups.empty() && holds.groups && !holds.group_numbers)
    losses.push_back(fmt::format("numbers of {} physical groups", mesh.groups.size()));
  if (has_element_in_several_groups(mesh) && holds.groups && !holds.several_groups)
    losses.emplace_back("all but the first group of elements in several");
  if (!mesh.periodic_links.empty() && !holds.periodic_links)
    losses.push_back(fmt::format("{} periodic links", mesh.periodic_links.size()));
  if (has_own_numbers(mesh) && !holds.tags) losses.emplace_back("numbers of nodes and elements");
  if (plan.format->losses != nullptr)
    for (std::string& loss : plan.format->losses(mesh)) losses.push_back(std::move(loss));
  if (!holds.full_precision) losses.emplace_back("digits of positions beyond float32");
  if (mesh.source != nullptr) losses.emplace_back("comments and data of the input file");
  return losses;
}

bool carries_fields(const Mesh& mesh, const std::filesystem::path& path,
                    const WriteOptions& options) {
  const WritePlan plan = make_plan(mesh, path, options);
  return !plan.copies_source && plan.format->holds.point_fields;
}

bool carries_volumes(const Mesh& mesh, const std::filesystem::path& path,
                     const WriteOptions& options) {
  const WritePlan plan = make_plan(mesh, path, options);
  return plan.copies_source || plan.format->holds.most_dimension == 3;
}

void write_text(const std::string& text, const std::filesystem::path& path) {
  detail::OutputFile output(path);
  output.write(text);
  output.commit();
}

void check_output(const Mesh& mesh, const std::filesystem::path& path,
                  const WriteOptions& options) {
  make_plan(mesh, path, options);
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
  if (mesh.source != nullptr && detail::file_format(mesh.format).spacing != nullptr)
    if (const double own = detail::file_format(mesh.format).spacing(mesh); own > 0) return own;
  return spacing_at(
      mesh, mesh.source != nullptr && mesh.source->coordinates == detail::NumberFormat::float32);
}

double coordinate_spacing(const Mesh& mesh, const std::filesystem::path& path,
                          const WriteOptions& options) {
  const WritePlan plan = make_plan(mesh, path, options);
  if (plan.copies_source) return coordinate_spacing(mesh);
  if (plan.format->new_spacing != nullptr) return plan.format->new_spacing(mesh);
  return spacing_at(mesh, !holds_of(plan).full_precision);
}

}  // namespace roughmesh
