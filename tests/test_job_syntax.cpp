// SPDX-License-Identifier: BSD-3-Clause
// Job files of any content are read or refused in one line; none ends the program.
#include <gtest/gtest.h>

#include "roughmesh/options.hpp"

#include "support/files.hpp"

using namespace roughmesh;

namespace {

RoughenOptions read_job_text(const std::string& text) {
  const test::TemporaryFolder folder;
  test::write_bytes(folder / "job", text);
  return read_job(folder / "job");
}

std::string repeated(const std::string& text, std::size_t n) {
  std::string result;
  result.reserve(n * text.size());
  for (std::size_t i = 0; i < n; ++i) result += text;
  return result;
}

/// Message of the error that reading the job throws; empty if it does not.
template <class Kind>
std::string message_of(const std::string& text) {
  try {
    read_job_text(text);
  } catch (const Kind& error) {
    return error.what();
  }
  return "";
}

}  // namespace

TEST(JobSyntax, EndlessNestingIsRefusedAndDoesNotUseUpTheStack) {
  const std::size_t n = 200000;
  const std::string keys = repeated("a.", n) + "a";
  const std::string lists = repeated("[", n), ends = repeated("]", n);
  for (const std::string& text :
       {std::string(R"({"rms":)") + repeated("[", 10 * n), R"({"request":)" + lists + ends + "}",
        std::string(R"({"rms":)") + repeated(R"({"a":)", n) + "1" + repeated("}", n) + "}",
        keys + " = 1", "[" + keys + "]\n", std::string("x = {") + repeated("a . ", n) + "a = 1}",
        std::string("[") + repeated("'a'.", n) + "a]\n", "x = '''\\'''''\n" + keys + " = 1",
        "x = \"\\\"\"\n" + keys + " = 1", "x = 'a\\'\n" + keys + " = 1", "rms = " + lists}) {
    const std::string message = message_of<FormatError>(text);
    EXPECT_NE(message.find("32 lists or tables"), std::string::npos) << text.substr(0, 40);
    EXPECT_LT(message.size(), 200U);
  }
}

TEST(JobSyntax, BracketsAndDotsInTextsAndCommentsAreNoNesting) {
  const std::string many = repeated("[.{", 100);
  for (const std::string& text :
       {"output = \"" + many + "\"", "output = '" + many + "'",
        "output = \"\"\"\n" + many + "\\\"\"\"\"\"", "# " + many + "\noutput = 'a'",
        "output = '''" + many + "'''''", R"({"output": "\")" + many + "\"}"})
    EXPECT_FALSE(read_job_text(text).output.empty()) << text;
  const std::string numbers = "length = [" + repeated("1.5, ", 100) + "1.5]";
  EXPECT_EQ(read_job_text(numbers).surfaces[0].length.size(), 101U);
}

TEST(JobSyntax, ATableWithoutANameIsRefused) {
  for (const std::string text :
       {"[[#a]]\n", "[#]\n", "[\n", "[[[a]]]\n", "rms = 1\n [ \t=]\n", "\xef\xbb\xbf[#]\n"})
    EXPECT_NE(message_of<FormatError>(text).find("table without a name"), std::string::npos)
        << text;
  for (const std::string text : {"[]", "[[]]", "[", "[[", "[a", "[ ", "[[ ]"})
    EXPECT_FALSE(message_of<FormatError>(text).empty()) << text;
}

TEST(JobSyntax, SignsBeyondAsciiStandInTextsAndCommentsOnly) {
  const std::string e = "\xc3\xa9";
  for (const std::string& text :
       {e, "[[" + e + "]]", "rms = 1 " + e, "rms" + e + " = 1",
        "output = \"\"\"\\ \n " + e + "\"\"\"", "output = \"\"\"\\" + e + "\"\"\"", "rms = 1" + e})
    EXPECT_NE(message_of<FormatError>(text).find("beyond ASCII"), std::string::npos) << text;
  for (const std::string& text :
       {"\xef\xbb\xbf# " + e + "\noutput = '" + e + "'", "output = \"\\\"" + e + "\"",
        "output = \"\"\"\\\n a\\\"" + e + "\"\"\""})
    EXPECT_NE(read_job_text(text).output.find(e), std::string::npos) << text;
}

TEST(JobSyntax, BracketsMatch) {
  for (const std::string text : {"length = [0,} 1]", "x = {a = [1}]", "x = {]", "x = 1]", "]", "}"})
    EXPECT_NE(message_of<FormatError>(text).find("was not opened"), std::string::npos) << text;
}

TEST(JobSyntax, TextsBeginWhereAKeyOrAValueMay) {
  for (const std::string text :
       {"x = 6+8u\"-'\n", "x = 1.\"a\"", "x = 1=\"a\"", "x = 1[\"a\"]", "x = 1{\"a\" = 1}",
        "x = 1'a'", "x = true.'a'", "a\"b\" = 1", "a 'b' = 1", "x = [1 'a']", "x = 'a' 'b'",
        "[a'b']", "[a] 'b'", "x = {a = 1 'b'}"})
    EXPECT_NE(message_of<FormatError>(text).find("none is expected"), std::string::npos) << text;
  for (const std::string text :
       {"'output'='a'", "'output'\t= \"a\" # 'b'", "unit = 'm'\r\noutput = 'a'\r\n",
        "unit = \"\"\"m\"\"\"\n\"output\" = '''a'''", "[[surface]]\n'group' = [ 'a',\n 'b' ]",
        "[[ surface ]] # 'a'\n\"group\" = [\"a\", # 'b\n]", "[['surface']]\nrms = 1.5e+3\n",
        "surface = [{ 'rms' = 1, \"length\" = [1] }]"})
    EXPECT_EQ(message_of<FormatError>(text), "") << text;
}

TEST(JobSyntax, SignsStandWhereTomlHasThem) {
  using namespace std::string_literals;
  for (const std::string& text :
       {"= 1"s,     ", 'a'"s,   "a..b = 1"s,  ".a = 1"s, "a == 1"s,   "a = 1 = 2"s, "a = 1, b = 2"s,
        "a = [,]"s, "a = {,}"s, "a = [1]{}"s, "a [1]"s,  "a: 1"s,     "a = @b"s,    "a = b\\c"s,
        "a = (1)"s, "a = 1\0"s, "a\0 = 1"s,   "\x01"s,   "a = \x7f"s, "a = [1\v]"s, "a = 1\f"s,
        "a = 1;"s,  "[a = 1]"s, "[a,b]"s,     "a = %1"s})
    EXPECT_NE(message_of<FormatError>(text).find("none is expected"), std::string::npos) << text;
  for (const std::string& text : {"a = 'b\0'"s, "a = \"b\x01\""s, "a = '''\x7f'''"s, "# \0"s})
    EXPECT_FALSE(message_of<FormatError>(text).empty()) << text;
}

TEST(JobSyntax, WordsAreNumbersOrTruths) {
  for (const std::string text :
       {"x = gaussian", "x = .5",       "x = 1.",    "x = 1.e3", "x = 1e",
        "x = 1e+",      "x = 0x",       "x = 0b2",   "x = 0xg",  "x = True",
        "x = +true",    "x = infinite", "x = --1",   "x = 1-2",  "x = 1+2",
        "x = 1e5e5",    "x = 1.2.3",    "x = 0x1p3", "x = _1",   "x = [1:2]"})
    EXPECT_NE(message_of<FormatError>(text).find("neither a number"), std::string::npos) << text;
  for (const std::string text : {"x = 1979-05-27", "x = 1979-05-27 07:32:00", "x = 07:32:00",
                                 "x = [1979-05-27T07:32:00Z]", "x = 1979-05-27T:"})
    EXPECT_NE(message_of<InputError>(text).find("dates and times"), std::string::npos) << text;
  for (const std::string text : {"x = 1 2", "x = [1 2]", "x = {a = 1 2}", "x = 'a' true"})
    EXPECT_NE(message_of<FormatError>(text).find(" is expected"), std::string::npos) << text;
  for (const std::string text :
       {"rms = 1", "rms = +1.5e-3", "rms = 1E2", "rms = 1_000.5_0", "rms = 0x1F", "rms = 0o17",
        "rms = 0b1_0", "rms = inf", "rms = -nan", "flip = true", "flip = false"})
    EXPECT_EQ(message_of<FormatError>(text), "") << text;
}

TEST(JobSyntax, MessagesAreShortAndInOneLine) {
  const std::string key = "\"a\\nb\" = 1";
  for (const std::string& text : {std::string("rms = [[1], [2]]"), std::string("rms = {a = 1}"),
                                  std::string("acf = '") + repeated("\xc3\xa9", 1000) + "'", key,
                                  "[[mask]]\nkind = 'formula'\nexpression = 'x'\n" + key}) {
    const std::string message = message_of<InputError>(text);
    EXPECT_FALSE(message.empty()) << text;
    EXPECT_LT(message.size(), 300U) << message;
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
  }
}
