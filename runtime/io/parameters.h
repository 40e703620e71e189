// The $parameters of a scene file and the text that they stand for.
#pragma once

#include "runtime/io/limits.h"
#include "runtime/io/location.h"

#include <cstddef>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace gradus {

class Diagnostics;

class Parameters {
  public:
    /// `given` on the command line go before what files say.
    Parameters(const std::map<std::string, std::string> &given, const LoadLimits &limits);

    /// Of several values the first counts. Throws Error(ExitCode::scene) for a name that is too long.
    void add_default(const std::string &name, const std::string &value, const Location &location);

    /// Replaces each $name. False where one has no value, or where they name each other in a circle: a file that is
    /// still to be read may mend that. Throws Error(ExitCode::scene) where the text grows beyond the limits.
    bool try_expand(const std::string &text, const Location &location, std::string &result);
    /// The same, but throws Error(ExitCode::scene) with what is missing.
    std::string expand(const std::string &text, const Location &location);
    /// The same, but what is missing is an error among others, told once, and the text is empty.
    std::string expand_or_tell(const std::string &text, const Location &location, Diagnostics &diagnostics);

    /// Throws Error(ExitCode::scene) for those given on the command line that the scene does not have.
    void check_given() const;

  private:
    using Values = std::map<std::string, std::string, std::less<>>;

    bool append(std::string_view text, const Location &location, int depth, std::string &result);
    /// What is to be said of a problem after a try that failed.
    std::string told_missing(const std::string &problem) const;
    const std::string *expanded(const std::string &name, const std::string &value, const Location &location, int depth);

    const std::map<std::string, std::string> &given_;
    const LoadLimits limits_;
    Values values_;
    Values expanded_;                   ///< each expanded once, however often it is named
    std::set<std::string> used_, told_; ///< told_: those that are missing
    std::uint64_t spent_ = 0;           ///< bytes that parameters stood for so far
    std::size_t longest_name_ = 0;
    std::vector<std::string> problems_; ///< of the last try that failed: names, or none for a circle
};

} // namespace gradus
