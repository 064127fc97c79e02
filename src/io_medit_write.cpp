// SPDX-License-Identifier: BSD-3-Clause
// Writes a mesh as Medit text or binary from its arrays.
#include <utility>

#include <fmt/format.h>

#include "io_medit.hpp"
#include "new_file.hpp"
#include "number_writer.hpp"

namespace roughmesh::detail {
namespace {

// Those with a section of the same shape in some order; points have none.
bool is_lost(const ElementBlock& block) { return block.type.shape == ElementShape::point; }

std::int64_t n_of_type(const Mesh& mesh, const ElementType& type) {
  std::int64_t n = 0;
  for (const ElementBlock& block : mesh.blocks)
    if (block.type == type) n += block.size();
  return n;
}

// In a binary file version 3 has whole numbers of four bytes, version 4 of eight.
class Writer {
 public:
  Writer(const Mesh& mesh, OutputFile& output, Encoding encoding)
      : mesh_(&mesh), numbers_(output, encoding) {
    for (const ElementBlock& block : mesh.blocks)
      is_wide_ |= !std::in_range<std::int32_t>(first_group(block));
  }

  void write_all() {
    write_head();
    write_vertices();
    for (const MeditElements& elements : medit_elements())
      if (n_of_type(*mesh_, elements.type) > 0) write_elements(elements);
    write_end();
  }

 private:
  std::size_t integer_bytes() const { return is_wide_ ? 8 : 4; }

  void integer(Tag value) {
    if (is_wide_)
      numbers_.number(value);
    else
      numbers_.number(static_cast<std::int32_t>(value));
  }

  void write_head() {
    if (numbers_.is_text()) return numbers_.text("MeshVersionFormatted 2\nDimension 3\n");
    constexpr std::size_t head_bytes = 24;
    numbers_.number(std::int32_t{1});
    numbers_.number(std::int32_t{is_wide_ ? 4 : 3});
    numbers_.number(std::int32_t{medit_code::dimension});
    numbers_.number(std::int64_t{head_bytes});
    numbers_.number(std::int32_t{3});
    position_ = head_bytes;
  }

  void begin(std::string_view keyword, int code, std::int64_t n, std::size_t bytes_each) {
    if (numbers_.is_text()) return numbers_.text(fmt::format("{}\n{}\n", keyword, n));
    position_ +=
        static_cast<std::int64_t>(12 + integer_bytes()) + n * static_cast<std::int64_t>(bytes_each);
    numbers_.number(std::int32_t{code});
    numbers_.number(position_);
    integer(n);
  }

  void write_vertices() {
    begin("Vertices", medit_code::vertices, mesh_->n_nodes(), 24 + integer_bytes());
    for (const Vec3& x : mesh_->nodes) {
      numbers_.vector(x);
      integer(0);
      numbers_.end_line();
    }
  }

  void write_elements(const MeditElements& elements) {
    const auto n_numbers = static_cast<std::size_t>(elements.type.n_nodes) + 1;
    begin(elements.keyword, elements.code, n_of_type(*mesh_, elements.type),
          n_numbers * integer_bytes());
    for (const ElementBlock& block : mesh_->blocks) {
      if (block.type != elements.type) continue;
      for (Index i = 0; i < block.size(); ++i) {
        for (const int place : elements.places)
          integer(Tag{block.element(i)[static_cast<std::size_t>(place)]} + 1);
        integer(first_group(block));
        numbers_.end_line();
      }
    }
  }

  void write_end() {
    if (numbers_.is_text()) return numbers_.text("End\n");
    numbers_.number(std::int32_t{medit_code::end});
    numbers_.number(std::int64_t{0});
  }

  const Mesh* mesh_;
  NumberWriter numbers_;
  bool is_wide_ = false;
  std::int64_t position_ = 0;
};

}  // namespace

void check_for_medit(const Mesh& mesh, const std::filesystem::path& path) {
  bool has_elements = false;
  for (const ElementBlock& block : mesh.blocks) {
    if (block.size() == 0 || is_lost(block)) continue;
    has_elements = true;
    if (medit_elements_of(block.type) == nullptr)
      throw InputError(fmt::format("{}: the Medit format has no {} with {} nodes; write .msh",
                                   path.string(), name(block.type), block.type.n_nodes));
  }
  if (!has_elements)
    throw InputError(
        fmt::format("{}: a mesh of points alone cannot be written to this format; "
                    "write .msh",
                    path.string()));
}

std::vector<std::string> losses_of_medit(const Mesh& mesh) {
  const std::int64_t n = n_elements(mesh, 0);
  if (n == 0) return {};
  return {fmt::format("{} elements of dimension 0", n)};
}

void write_new_medit(const Mesh& mesh, const WriteOptions& options, OutputFile& output) {
  Writer(mesh, output, options.encoding.value_or(Encoding::text)).write_all();
}

}  // namespace roughmesh::detail
