// SPDX-License-Identifier: BSD-3-Clause
#include "scratch_folder.hpp"

#include <atomic>
#include <cerrno>
#include <csignal>
#include <string>
#include <system_error>

#include <fmt/format.h>
#include <stdlib.h>
#include <sys/wait.h>
#include <unistd.h>

namespace roughmesh::detail {

// As UnfinishedFile in output_file.cpp: entries are reused and never freed, and a handler claims an
// entry before it reads the name.
class ScratchEntry {
 public:
  static ScratchEntry* enter(const std::string& name) {
    ScratchEntry* entry = take_free();
    entry->name_ = name;
    entry->child_.store(0);
    entry->state_.store(State::active);
    return entry;
  }

  void leave() {
    State expected = State::active;
    state_.compare_exchange_strong(expected, State::free);
  }

  void set_child(pid_t group) { child_.store(group); }

  static void discard_all() noexcept {
    for (ScratchEntry* entry = first.load(); entry != nullptr; entry = entry->next_) {
      State expected = State::active;
      if (entry->state_.compare_exchange_strong(expected, State::claimed)) entry->discard();
    }
  }

 private:
  enum class State { free, filling, active, claimed };

  static ScratchEntry* take_free() {
    for (ScratchEntry* entry = first.load(); entry != nullptr; entry = entry->next_) {
      State expected = State::free;
      if (entry->state_.compare_exchange_strong(expected, State::filling)) return entry;
    }
    auto* const entry = new ScratchEntry;
    entry->next_ = first.load();
    while (!first.compare_exchange_weak(entry->next_, entry)) {
    }
    return entry;
  }

  // Walking a folder allocates memory, which a signal handler must not; another process may.
  void discard() const noexcept {
    const pid_t child = child_.load();
    if (child > 0) ::kill(-child, SIGKILL);
    const pid_t remover = ::vfork();
    if (remover == 0) {
      ::execl("/bin/rm", "rm", "-rf", "--", name_.c_str(), static_cast<char*>(nullptr));
      ::_exit(127);
    }
    while (remover > 0 && ::waitpid(remover, nullptr, 0) < 0 && errno == EINTR) {
    }
  }

  static std::atomic<ScratchEntry*> first;
  static_assert(std::atomic<State>::is_always_lock_free && std::atomic<pid_t>::is_always_lock_free);

  std::atomic<State> state_ = State::filling;
  std::atomic<pid_t> child_ = 0;
  std::string name_;
  ScratchEntry* next_ = nullptr;
};

std::atomic<ScratchEntry*> ScratchEntry::first = nullptr;

ScratchFolder::ScratchFolder() {
  std::error_code failed;
  const std::filesystem::path parent = std::filesystem::temp_directory_path(failed);
  std::string name = (parent / "roughmesh-XXXXXX").string();
  if (failed || ::mkdtemp(name.data()) == nullptr)
    throw InputError(fmt::format(
        "{}: no temporary folder can be made; set TMPDIR to a folder that you may write",
        failed ? "TMPDIR" : parent.string()));
  path_ = name;
  entry_ = ScratchEntry::enter(name);
}

ScratchFolder::~ScratchFolder() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
  entry_->leave();
}

void ScratchFolder::set_child(pid_t group) const { entry_->set_child(group); }

void discard_scratch_folders() noexcept { ScratchEntry::discard_all(); }

}  // namespace roughmesh::detail
