// SPDX-License-Identifier: BSD-3-Clause
// What can go wrong, as kinds a caller can tell apart.
#pragma once

#include <stdexcept>
#include <string>

namespace roughmesh {

/// Base of every exception roughmesh throws. The message is one line that names the thing, the
/// value and the remedy; it has no final newline. Values come from outside: `?` stands for what
/// control characters they hold.
class Error : public std::runtime_error {
 public:
  explicit Error(std::string message);
};

/// An argument, option, input or resource that the caller can change: a length of 0, a group that
/// does not exist, a missing file, a full disk, too little memory. Exit code 2 of the command line.
class InputError : public Error {
 public:
  using Error::Error;
};

/// A file that is not what it claims to be, or is cut short. Names file, line (or byte) and
/// section. Exit code 3 of the command line.
class FormatError : public Error {
 public:
  using Error::Error;
};

/// A rough mesh that failed its check and was refused: how many elements, where, what to change.
/// Exit code 1 of the command line.
class CheckError : public Error {
 public:
  using Error::Error;
};

/// A computation that did not reach its accuracy. Exit code 4 of the command line.
class NumericalError : public Error {
 public:
  using Error::Error;
};

}  // namespace roughmesh
