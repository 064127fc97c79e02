// SPDX-License-Identifier: BSD-3-Clause
#include <cerrno>
#include <memory>
#include <system_error>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include "roughmesh/error.hpp"

#include "mesh_source.hpp"

namespace roughmesh::detail {
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

}  // namespace roughmesh::detail
