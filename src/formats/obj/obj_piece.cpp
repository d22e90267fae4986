// SPDX-License-Identifier: Apache-2.0
#include "formats/obj/obj_piece.h"

#include <algorithm>
#include <charconv>
#include <cmath>

namespace fathom {

namespace {

bool is_blank(char c)
{
    return c == ' ' || c == '\t';
}
bool ends_word(char c)
{
    return is_blank(c) || c == '\n' || c == '\r';
}

class PieceReader {
public:
    PieceReader(ObjPiece& piece, const std::string& file, std::size_t first_line)
        : piece_(piece), file_(file), at_(piece.text.data()), end_(at_ + piece.text.size()), line_(first_line)
    {
    }

    void read()
    {
        const std::size_t first_line = line_;
        while (at_ != end_)
            if (!read_usual_line()) read_any_line();
        piece_.lines = line_ - first_line;
    }

private:
    /// Fast path for positions, normals, texture coordinates and faces on one line without a comment. Returns false
    /// without side effects for all other and for invalid lines.
    bool read_usual_line()
    {
        // The text ends with a line end, which stops these comparisons in time.
        if (at_[0] == 'f' && is_blank(at_[1])) return read_usual_face(at_ + 2);
        if (at_[0] != 'v') return false;
        float n[7];
        if (is_blank(at_[1])) {
            const int count = numbers(at_ + 2, n, 7);
            if (count < 3) return false;
            add_position(n, count);
        } else if (at_[1] == 't' && is_blank(at_[2])) {
            const int count = numbers(at_ + 3, n, 3);
            if (count < 1) return false;
            piece_.uvs.push_back({n[0], 1 - (count > 1 ? n[1] : 0)});
        } else if (at_[1] == 'n' && is_blank(at_[2])) {
            if (numbers(at_ + 3, n, 3) != 3) return false;
            piece_.normals.push_back({n[0], n[1], n[2]});
        } else {
            return false;
        }
        go_on();
        return true;
    }

    /// Parses up to `most` numbers up to the line end and sets next_ behind it; -1 if the line has anything else.
    int numbers(const char* p, float* to, int most)
    {
        for (int count = 0;; ++count) {
            while (is_blank(*p)) ++p;
            if (is_line_end(p)) return count;
            if (count == most) return -1;
            double value = 0;
            const auto [after, error] = std::from_chars(p, end_, value);
            if (error != std::errc() || !ends_word(*after) ||
                !(std::abs(value) <= double(std::numeric_limits<float>::max())))
                return -1;
            to[count] = float(value);
            p = after;
        }
    }
    bool is_line_end(const char* p)
    {
        if (*p == '\r') ++p;
        next_ = p + 1;
        return *p == '\n';
    }
    void go_on()
    {
        at_ = next_;
        ++line_;
    }

    bool read_usual_face(const char* p)
    {
        const std::size_t before = piece_.corners.size();
        for (;;) {
            while (is_blank(*p)) ++p;
            if (is_line_end(p)) break;
            ObjCorner corner;
            if (!read_usual_corner(p, corner)) {
                piece_.corners.resize(before);
                return false;
            }
            piece_.corners.push_back(corner);
        }
        end_face();
        go_on();
        return true;
    }
    bool read_usual_corner(const char*& p, ObjCorner& corner) const
    {
        if (!integer(p, corner.position)) return false;
        if (*p == '/') {
            ++p;
            if (*p != '/' && !ends_word(*p) && !integer(p, corner.uv)) return false;
            if (*p == '/') {
                ++p;
                if (!ends_word(*p) && !integer(p, corner.normal)) return false;
            }
        }
        return ends_word(*p);
    }
    bool integer(const char*& p, std::int32_t& value) const
    {
        const auto [after, error] = std::from_chars(p, end_, value);
        p = after;
        return error == std::errc() && value != ObjCorner::absent;
    }

    void read_any_line()
    {
        TextScanner scan(file_, std::string_view(at_, std::size_t(end_ - at_)), line_, '#');
        read_line(scan);
        scan.next_line();
        at_ = scan.position();
        line_ = scan.line();
    }

    void read_line(TextScanner& scan)
    {
        using Read = void (PieceReader::*)(TextScanner&);
        static constexpr std::pair<std::string_view, Read> statements[] = {
            {"v", &PieceReader::read_position},
            {"vt", &PieceReader::read_uv},
            {"vn", &PieceReader::read_normal},
            {"f", &PieceReader::read_face},
            {"fo", &PieceReader::read_face},
            {"usemtl", &PieceReader::read_name<ObjPiece::Event::material>},
            {"mtllib", &PieceReader::read_name<ObjPiece::Event::library>},
            {"o", &PieceReader::read_name<ObjPiece::Event::object>},
            {"p", &PieceReader::read_points},
            {"l", &PieceReader::count<&ObjPiece::drawn_lines>},
            {"vp", &PieceReader::count<&ObjPiece::free_forms>},
            {"curv", &PieceReader::count<&ObjPiece::free_forms>},
            {"curv2", &PieceReader::count<&ObjPiece::free_forms>},
            {"surf", &PieceReader::count<&ObjPiece::free_forms>},
            {"cstype", &PieceReader::count<&ObjPiece::free_forms>}};
        static constexpr std::string_view ignored[] = {"g",      "s",        "mg",       "lod",        "usemap",
                                                       "maplib", "deg",      "end",      "parm",       "bevel",
                                                       "call",   "c_interp", "d_interp", "shadow_obj", "trace_obj"};
        const std::string_view key = scan.word();
        if (key.empty()) return;
        const auto* const found = std::find_if(std::begin(statements), std::end(statements),
                                               [&](const auto& statement) { return statement.first == key; });
        if (found != std::end(statements))
            (this->*found->second)(scan);
        else if (std::find(std::begin(ignored), std::end(ignored), key) == std::end(ignored))
            ++piece_.unknown_lines;
    }
    template <auto counter>
    void count(TextScanner&)
    {
        ++(piece_.*counter);
    }
    template <ObjPiece::Event::Kind kind>
    void read_name(TextScanner& scan)
    {
        add_event(kind, scan.rest());
    }
    void read_points(TextScanner& scan) { add_event(ObjPiece::Event::points, rest_of_any_lines(scan)); }

    void read_position(TextScanner& scan)
    {
        float n[7] = {scan.number(), scan.number(), scan.number()};
        int count = 3;
        for (; count < 7 && scan.line_has_more(); ++count) n[count] = scan.number();
        add_position(n, count);
    }
    /// The position may be followed by a weight, which is ignored, or by a color, a common extension.
    void add_position(const float* n, int count)
    {
        piece_.positions.push_back({n[0], n[1], n[2]});
        if (count >= 6) {
            if (piece_.colors.empty()) piece_.first_color = piece_.positions.size() - 1;
            piece_.colors.push_back({n[3], n[4], n[5], 1});
        } else if (!piece_.colors.empty()) {
            piece_.colors.push_back(ObjPiece::no_color);
        }
    }
    void read_uv(TextScanner& scan)
    {
        const float u = scan.number();
        const float v = scan.line_has_more() ? scan.number() : 0;
        piece_.uvs.push_back({u, 1 - v});
    }

    void read_normal(TextScanner& scan) { piece_.normals.push_back({scan.number(), scan.number(), scan.number()}); }

    void read_face(TextScanner& scan)
    {
        for (std::string_view word = scan.word(); !word.empty(); word = scan.word())
            piece_.corners.push_back(read_obj_corner(scan, word));
        end_face();
    }
    void end_face()
    {
        if (piece_.runs.empty() || piece_.runs.back().counts != piece_.counts())
            piece_.runs.push_back({piece_.face_ends.size(), piece_.counts()});
        piece_.face_ends.push_back(std::uint32_t(piece_.corners.size()));
    }

    void add_event(ObjPiece::Event::Kind kind, std::string_view rest)
    {
        piece_.events.push_back({kind, piece_.face_ends.size(), piece_.counts(), rest});
    }
    /// The rest of a line with its continuation lines, without a comment.
    static std::string_view rest_of_any_lines(TextScanner& scan)
    {
        const char* const start = scan.position();
        while (!scan.word().empty()) {
        }
        return {start, std::size_t(scan.position() - start)};
    }

    ObjPiece& piece_;
    const std::string& file_;
    const char* at_;  ///< start of the current line
    const char* end_;
    const char* next_ = nullptr;  ///< position behind the line end that is_line_end() found
    std::size_t line_;
};

}  // namespace

void ObjPiece::clear()
{
    lines = 0;
    positions.clear(), normals.clear(), uvs.clear(), colors.clear();
    corners.clear(), face_ends.clear(), runs.clear(), events.clear();
    drawn_lines = free_forms = unknown_lines = 0;
    is_damaged = false;
}

void read_obj_piece(ObjPiece& piece, const std::string& file, std::size_t first_line)
{
    piece.clear();
    PieceReader(piece, file, first_line).read();
}

long long read_obj_index(const TextScanner& scan, std::string_view word)
{
    return scan.to_integer<long long>(word);
}

ObjCorner read_obj_corner(const TextScanner& scan, std::string_view word)
{
    const auto cut = [&](std::string_view digits) {
        constexpr long long most = ObjCorner::most;
        return std::int32_t(std::clamp(read_obj_index(scan, digits), -most, most));
    };
    ObjCorner corner;
    const std::size_t slash = word.find('/');
    corner.position = cut(word.substr(0, slash));
    if (slash == std::string_view::npos) return corner;
    word.remove_prefix(slash + 1);
    const std::size_t second = word.find('/');
    if (const auto uv = word.substr(0, second); !uv.empty()) corner.uv = cut(uv);
    if (second == std::string_view::npos) return corner;
    word.remove_prefix(second + 1);
    if (!word.empty()) corner.normal = cut(word);
    return corner;
}

}  // namespace fathom
