#!/usr/bin/env perl
# What a command left: path and digest of every file below a folder, without temporary files. Measured times are blanked by name, and the
# name of the folder reads OUT, so that two runs of a command list the same.
# Usage: listing.pl FOLDER | listing.pl --show FILE    the latter prints the text whose digest is listed
use strict;
use warnings;
use Digest::SHA qw(sha256_hex);
use Encode qw(decode_utf8 encode_utf8);
use File::Find;

# Every name of a measured time is here. Columns and keys; in aggregate.csv with _mean, _se or _max behind.
my @time_names = qw(frontend_ms propagate_ms update_ms backend_ms backend_ms_p95 total_ms realtime_factor cpu_ms mean_ms p95_ms wall_s cpu_s);
my @time_headings = ('front end [ms]', 'back end [ms]', 'back end p95 [ms]', 'x real time [s/s]', 'ms a frame', '95 % of frames');
my @time_lists = qw(stages ms ms_quantiles);    # keys of the report whose lists hold nothing else

my %is_time = map { $_ => 1 } @time_names;
my %is_time_heading = map { $_ => 1 } @time_headings;
my ($name_pattern, $list_pattern) = (join('|', @time_names), join('|', @time_lists));

sub csv_without_times {
  my ($text) = @_;
  my (@blank, @lines);
  for my $line (split /\n/, $text, -1) {
    my @fields = $line =~ /(?:^|,)("(?:[^"]|"")*"|[^,]*)/g;
    @blank = map { s/_(?:mean|se|max)$//r } @fields if !@lines;
    push @lines, join ',', map { $is_time{ $blank[$_] // '' } && @lines ? '' : $fields[$_] } 0 .. $#fields;
  }
  return join "\n", @lines;
}

# Of run.json, score.json, report.json and of the data in report.html, whose figures stand in lists in the order of "figures".
sub json_without_times {
  my ($text) = @_;
  my @figures = $text =~ /"key":\s*"(\w+)",\s*"label"/g;
  my $blank = sub {
    my @values = split /,/, $_[0], -1;
    return $_[0] if @values != @figures;
    return join ',', map { $is_time{ $figures[$_] } ? '' : $values[$_] } 0 .. $#values;
  };
  $text =~ s/("(?:means|errors|best|figures)":\s*\[)([^][{}]*)\]/$1 . $blank->($2) . ']'/ge;
  $text =~ s/("(?:$list_pattern)":\s*\[)[^][{}]*\]/$1]/g;
  $text =~ s/("(?:$name_pattern)":\s*)(?:null|[-+.0-9eE]+)/$1/g;
  return $text;
}

# Tables whose first line names the columns. `cells` takes a line apart: undef where it is none of a table, empty where it is a rule.
sub table_without_times {
  my ($text, $separator, $cells) = @_;
  my ($blank, @lines);
  for my $line (split /\n/, $text, -1) {
    my $of_line = $cells->($line);
    if (!$of_line) {
      undef $blank;
    } elsif (@$of_line && !$blank) {
      $blank = [map { $is_time_heading{ s/\\(.)/$1/gr } } @$of_line];
    } elsif (@$of_line) {
      $line = join $separator, map { $blank->[$_] ? '' : $of_line->[$_] } 0 .. $#$of_line;
    }
    push @lines, $line;
  }
  return join "\n", @lines;
}

sub markdown_cells {
  my ($line) = @_;
  return $line =~ /^\|:-/ ? [] : $line =~ /^\| (.*) \|$/ ? [split / \| /, $1, -1] : undef;
}

sub latex_cells {
  my ($line) = @_;
  return $line =~ /^    \\midrule$/ ? [] : $line =~ /^    (.* & .*) \\\\$/ ? [split / & /, $1, -1] : undef;
}

# The tables for a terminal, whose columns are as wide as what is in them: columns of times are cut out.
sub terminal_without_times {
  my ($text) = @_;
  my @lines = split /\n/, decode_utf8($text), -1;
  for my $i (1 .. $#lines) {
    next if $lines[$i] !~ /^  -+$/ || $lines[ $i - 1 ] !~ /^  \S/;
    my ($heads, $before, @spans) = ($lines[ $i - 1 ], 0);
    while ($heads =~ /(\S+(?: \S+)*)/g) {
      my $end = pos $heads;
      unshift @spans, [$before + 1, $end + 1] if $is_time_heading{$1};    # a star may stand behind a number
      $before = $end;
    }
    for (my $row = $i - 1; $row <= $#lines && $lines[$row] ne ''; ++$row) {
      substr($lines[$row], $_->[0], $_->[1] - $_->[0]) = '' for grep { $_->[1] <= length $lines[$row] } @spans;
      $lines[$row] =~ s/^  -+$/  ---/;
    }
  }
  return encode_utf8(join "\n", @lines);
}

# One item of CBOR (RFC 8949, definite lengths) from position $$at on, as text; a map without its times, and without what tells a run
# that --resume kept.
sub cbor_item {
  my ($bytes, $at) = @_;
  my $take = sub {
    my ($size) = @_;
    die "cut off\n" if $$at + $size > length $bytes;
    $$at += $size;
    return substr $bytes, $$at - $size, $size;
  };
  my $head = ord $take->(1);
  my ($major, $value) = ($head >> 5, $head & 31);
  if ($value >= 24) {
    my $digits = unpack 'H*', $take->(1 << ($value - 24));
    $value = $major == 7 ? "float $digits" : hex $digits;
  }
  return $take->($value) if $major == 2 || $major == 3;
  return '[' . join(',', map { cbor_item($bytes, $at) } 1 .. $value) . ']' if $major == 4;
  return "$major:$value" if $major != 5;
  my @members;
  for (1 .. $value) {
    my ($key, $of_key) = (cbor_item($bytes, $at), cbor_item($bytes, $at));
    push @members, "$key=$of_key" if !$is_time{$key} && $key ne 'reused';
  }
  return '{' . join(',', @members) . '}';
}

sub cbor_without_times {
  my ($bytes) = @_;
  my $at = 0;
  my $text = eval { cbor_item($bytes, \$at) };
  return defined $text && $at == length $bytes ? $text : "no CBOR: $bytes";
}

sub without_times {
  my ($path, $text) = @_;
  return csv_without_times($text) if $path =~ /\.csv$/;
  return json_without_times($text) if $path =~ /\.json$/;
  return table_without_times($text, ' | ', \&markdown_cells) if $path =~ /\.md$/;
  return table_without_times($text, ' & ', \&latex_cells) if $path =~ /\.tex$/;
  if ($path =~ /\.html$/) {
    $text =~ s/(<script [^>]*id="data">)(.*?)(<\/script>)/$1 . json_without_times($2) . $3/se;
    $text =~ s/(<pre>)(.*?)(<\/pre>)/$1 . terminal_without_times($2) . $3/se;
  }
  $text =~ s/(<svg [^>]*>).*(<\/svg>)/$1$2/s if $path =~ /_time\.svg$/;    # times alone
  return cbor_without_times($text) if $path =~ /\.cbor$/;
  return $text;
}

sub listed_text {
  my ($path, $folder) = @_;
  open my $file, '<:raw', $path or die "$path: $!\n";
  local $/;
  my $text = without_times($path, scalar <$file>);
  $text =~ s/\b\Q$folder\E\b/OUT/g if defined $folder;
  return $text;
}

my ($folder, $file) = @ARGV;
if ($folder eq '--show') {
  print listed_text($file);
} elsif (-d $folder) {
  my @paths;
  find({ wanted => sub { push @paths, $_ if -f && !-l }, no_chdir => 1 }, $folder);
  for my $path (sort @paths) {
    my $name = substr $path, length $folder;
    print "OUT$name ", sha256_hex(listed_text($path, $folder)), "\n" if $name !~ m{\.tmp\d+_\d+$|\.part$|\.running$|^/provisional/};
  }
}
