#!/usr/bin/env perl
# Serves the files of FOLDER over HTTP on a free port of this machine, slowly, whole or from a byte on. Prints the port.
# Usage: slow_server.pl FOLDER
use strict;
use warnings;
use IO::Handle;
use IO::Socket::INET;

my ($folder) = @ARGV;
my $server = IO::Socket::INET->new(LocalAddr => '127.0.0.1', Listen => 16) or die "no port: $!\n";
local $SIG{PIPE} = 'IGNORE';    # of clients that are killed
STDOUT->autoflush;
print $server->sockport, "\n";
while (my $client = $server->accept) {
  my ($path, $first) = ('', 0);
  while (defined(my $line = <$client>)) {
    $path = $1 if $line =~ m{^GET /(\w+) };
    $first = $1 if $line =~ /^Range: bytes=(\d+)-\r$/i;
    last if $line eq "\r\n";
  }
  open my $file, '<:raw', "$folder/$path" or die "$path: $!\n";
  my $size = -s $file;
  seek $file, $first, 0;
  my $status = $first > 0 ? "206 Partial Content\r\nContent-Range: bytes $first-" . ($size - 1) . "/$size" : '200 OK';
  print {$client} "HTTP/1.1 $status\r\nContent-Length: ", $size - $first, "\r\nConnection: close\r\n\r\n";
  while (read $file, my $piece, 4096) {
    print {$client} $piece or last;
    $client->flush or last;
    select undef, undef, undef, 0.01;
  }
  close $client;
}
