// SPDX-License-Identifier: BSD-3-Clause
#include "output_file.hpp"

#include <atomic>
#include <cerrno>
#include <system_error>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include "roughmesh/mesh_io.hpp"

#include "scratch_folder.hpp"

namespace roughmesh {
namespace detail {

// One entry of the list that discard_unfinished_files() walks. Entries are reused and never freed,
// and a handler claims an entry before it reads the name, so that nothing changes under it.
class UnfinishedFile {
 public:
  static UnfinishedFile* enter(const std::string& name) {
    UnfinishedFile* entry = take_free();
    entry->name_ = name;
    entry->state_.store(State::active);
    return entry;
  }

  void leave() {
    State expected = State::active;
    state_.compare_exchange_strong(expected, State::free);
  }

  static void discard_all() noexcept {
    for (UnfinishedFile* entry = first.load(); entry != nullptr; entry = entry->next_) {
      State expected = State::active;
      if (entry->state_.compare_exchange_strong(expected, State::claimed))
        ::unlink(entry->name_.c_str());
    }
  }

 private:
  enum class State { free, filling, active, claimed };

  static UnfinishedFile* take_free() {
    for (UnfinishedFile* entry = first.load(); entry != nullptr; entry = entry->next_) {
      State expected = State::free;
      if (entry->state_.compare_exchange_strong(expected, State::filling)) return entry;
    }
    auto* const entry = new UnfinishedFile;
    entry->next_ = first.load();
    while (!first.compare_exchange_weak(entry->next_, entry)) {
    }
    return entry;
  }

  static std::atomic<UnfinishedFile*> first;
  static_assert(std::atomic<State>::is_always_lock_free);

  std::atomic<State> state_ = State::filling;
  std::string name_;
  UnfinishedFile* next_ = nullptr;
};

std::atomic<UnfinishedFile*> UnfinishedFile::first = nullptr;

namespace {

constexpr std::size_t buffer_size = std::size_t{1} << 20;

const char* remedy(int error) {
  switch (error) {
    case ENOSPC:
    case EDQUOT:
      return "free some space or choose another folder";
    case EFBIG:
      return "raise the limit (ulimit -f) or choose another disk";
    case EACCES:
    case EPERM:
    case EROFS:
      return "choose a file and folder that you may write";
    case ENOENT:
    case ENOTDIR:
      return "make the folder first";
    case EISDIR:
      return "name a file in it";
    default:
      return "choose another file";
  }
}

std::filesystem::path follow_links(const std::filesystem::path& path) {
  std::error_code ignored;
  if (!std::filesystem::is_symlink(path, ignored)) return path;
  const std::filesystem::path target = std::filesystem::weakly_canonical(path, ignored);
  return ignored ? path : target;
}

std::filesystem::path temporary_name(const std::filesystem::path& target) {
  static std::atomic<unsigned> counter = 0;
  return target.parent_path() / fmt::format(".roughmesh-{}-{}.part", ::getpid(), counter++);
}

}  // namespace

OutputFile::OutputFile(const std::filesystem::path& path)
    : path_(path), target_(follow_links(path)) {
  struct stat existing {};
  const bool exists = ::stat(target_.c_str(), &existing) == 0;
  if (exists && S_ISDIR(existing.st_mode)) fail(EISDIR);
  // Renaming would replace a file that forbids writing, which its owner does not expect.
  if (exists && ::access(target_.c_str(), W_OK) != 0) fail(errno);
  if (exists && !S_ISREG(existing.st_mode))
    open_directly();
  else
    open_beside();
}

OutputFile::~OutputFile() {
  if (descriptor_ >= 0) ::close(descriptor_);
  if (unfinished_ == nullptr) return;
  ::unlink(beside_.c_str());
  unfinished_->leave();
}

void OutputFile::open_beside() {
  constexpr mode_t before_umask = 0666;
  do {
    if (unfinished_ != nullptr) unfinished_->leave();
    beside_ = temporary_name(target_);
    unfinished_ = UnfinishedFile::enter(std::filesystem::absolute(beside_).string());
    descriptor_ = ::open(beside_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, before_umask);
  } while (descriptor_ < 0 && errno == EEXIST);
  if (descriptor_ >= 0) return keep_permissions();
  const int error = errno;
  unfinished_->leave();
  fail(error);
}

void OutputFile::open_directly() {
  descriptor_ = ::open(target_.c_str(), O_WRONLY | O_CLOEXEC);
  if (descriptor_ < 0) fail(errno);
}

// As far as the system allows: the bits are a convenience, the file's content is not.
void OutputFile::keep_permissions() const {
  struct stat existing {};
  constexpr mode_t bits = 0777;
  if (::stat(target_.c_str(), &existing) != 0) return;
  if (::fchmod(descriptor_, existing.st_mode & bits) != 0) errno = 0;
}

void OutputFile::write(std::string_view bytes) {
  if (buffer_.size() + bytes.size() > buffer_size) flush();
  if (bytes.size() > buffer_size)
    write_all(bytes);
  else
    buffer_ += bytes;
}

void OutputFile::flush() {
  write_all(buffer_);
  buffer_.clear();
}

void OutputFile::write_all(std::string_view bytes) const {
  while (!bytes.empty()) {
    const ssize_t n = ::write(descriptor_, bytes.data(), bytes.size());
    if (n < 0 && errno != EINTR) fail(errno);
    if (n > 0) bytes.remove_prefix(static_cast<std::size_t>(n));
  }
}

void OutputFile::close_checked() {
  const int descriptor = descriptor_;
  descriptor_ = -1;
  if (::close(descriptor) != 0 && errno != EINTR) fail(errno);
}

void OutputFile::commit() {
  flush();
  close_checked();
  if (unfinished_ == nullptr) return;
  if (::rename(beside_.c_str(), target_.c_str()) != 0) fail(errno);
  unfinished_->leave();
  unfinished_ = nullptr;
}

void OutputFile::fail(int error) const {
  throw InputError(fmt::format("{}: cannot be written: {}; {}", path_.string(),
                               std::generic_category().message(error), remedy(error)));
}

}  // namespace detail

void discard_unfinished_files() noexcept {
  detail::UnfinishedFile::discard_all();
  detail::discard_scratch_folders();
}

}  // namespace roughmesh
