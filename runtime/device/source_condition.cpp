#include "runtime/device/source_condition.h"

#include <algorithm>
#include <charconv>
#include <limits>
#include <string_view>
#include <utility>

namespace gradus {

namespace {

/// By precedence climbing, in 64 bits with a sign. What overflows them is not understood; nor is a negative number in a
/// condition with one that has no sign, which would make it a large one.
class Condition {
  public:
    explicit Condition(const std::vector<SourceToken> &tokens)
        : tokens_(tokens), has_unsigned_(std::any_of(tokens.begin(), tokens.end(), is_unsigned)) {}

    std::int64_t value() {
        const std::int64_t result = choice();
        if (at_ != tokens_.size())
            throw NotUnderstood("a condition that goes on");
        return result;
    }

  private:
    static constexpr std::int64_t least = std::numeric_limits<std::int64_t>::min();

    static bool is_unsigned(const SourceToken &token) {
        return token.kind == SourceToken::Kind::number && token.spelling.find_first_of("uU") != std::string_view::npos;
    }

    std::int64_t checked(std::int64_t value) const {
        return value < 0 && has_unsigned_ ? throw NotUnderstood("a negative number among unsigned ones") : value;
    }

    bool take(std::string_view spelling) {
        if (at_ == tokens_.size() || !tokens_[at_].is(spelling))
            return false;
        ++at_;
        return true;
    }

    std::int64_t choice() {
        const std::int64_t condition = binary(0);
        if (!take("?"))
            return condition;
        const std::int64_t first = choice();
        if (!take(":"))
            throw NotUnderstood("? without :");
        const std::int64_t second = choice();
        return condition ? first : second;
    }

    static int precedence(std::string_view operation) {
        static constexpr std::pair<std::string_view, int> known[] = {
            {"||", 1}, {"&&", 2}, {"|", 3},  {"^", 4},  {"&", 5}, {"==", 6}, {"!=", 6}, {"<", 7},  {">", 7},
            {"<=", 7}, {">=", 7}, {"<<", 8}, {">>", 8}, {"+", 9}, {"-", 9},  {"*", 10}, {"/", 10}, {"%", 10}};
        for (const auto &[spelling, level] : known)
            if (operation == spelling)
                return level;
        return 0;
    }

    std::int64_t binary(int above) {
        std::int64_t left = unary();
        while (at_ < tokens_.size()) {
            const std::string_view operation = tokens_[at_].spelling;
            const int level = precedence(operation);
            if (level <= above)
                break;
            ++at_;
            left = checked(result(operation, left, binary(level)));
        }
        return left;
    }

    static std::int64_t result(std::string_view operation, std::int64_t a, std::int64_t b) {
        if ((operation == "/" || operation == "%") && (b == 0 || (b == -1 && a == least)))
            throw NotUnderstood("a division without a result");
        if ((operation == "<<" || operation == ">>") && (b < 0 || b > 63))
            throw NotUnderstood("a shift without a result");
        if (operation == "||")
            return a || b;
        if (operation == "&&")
            return a && b;
        if (operation == "|")
            return a | b;
        if (operation == "^")
            return a ^ b;
        if (operation == "&")
            return a & b;
        if (operation == "==")
            return a == b;
        if (operation == "!=")
            return a != b;
        if (operation == "<")
            return a < b;
        if (operation == ">")
            return a > b;
        if (operation == "<=")
            return a <= b;
        if (operation == ">=")
            return a >= b;
        if (operation == "<<")
            return (a << b) >> b == a ? a << b : throw NotUnderstood("an overflow");
        if (operation == ">>")
            return a >> b;
        std::int64_t exact = 0;
        if (operation == "+" && !__builtin_add_overflow(a, b, &exact))
            return exact;
        if (operation == "-" && !__builtin_sub_overflow(a, b, &exact))
            return exact;
        if (operation == "*" && !__builtin_mul_overflow(a, b, &exact))
            return exact;
        if (operation == "/")
            return a / b;
        if (operation == "%")
            return a % b;
        throw NotUnderstood("an overflow");
    }

    std::int64_t unary() {
        if (at_ == tokens_.size())
            throw NotUnderstood("a condition that ends early");
        if (take("!"))
            return !unary();
        if (take("-"))
            return checked(result("-", 0, unary()));
        if (take("+"))
            return unary();
        if (take("~"))
            return checked(~unary());
        if (take("(")) {
            const std::int64_t inner = choice();
            if (!take(")"))
                throw NotUnderstood("( without )");
            return inner;
        }
        const SourceToken &token = tokens_[at_++];
        if (token.kind == SourceToken::Kind::identifier)
            return 0;
        if (token.kind != SourceToken::Kind::number)
            throw NotUnderstood("a condition of other things");
        std::string_view digits = token.spelling;
        int base = 10;
        if (digits.starts_with("0x") || digits.starts_with("0X")) {
            base = 16;
            digits.remove_prefix(2);
        } else if (digits.size() > 1 && digits[0] == '0') {
            base = 8;
        }
        std::int64_t number = 0;
        const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), number, base);
        digits.remove_prefix(static_cast<std::size_t>(end - digits.data()));
        if (error != std::errc() || digits.find_first_not_of("uUlL") != std::string_view::npos)
            throw NotUnderstood("a number that is not whole");
        return number;
    }

    const std::vector<SourceToken> &tokens_;
    bool has_unsigned_;
    std::size_t at_ = 0;
};

} // namespace

std::int64_t value_of_condition(const std::vector<SourceToken> &tokens) { return Condition(tokens).value(); }

} // namespace gradus
